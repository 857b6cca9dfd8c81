// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "resight/geometry/rigid3.hpp"

namespace resight {

/// An object recognised in a single view.
struct ObservedObject {
  int view = 0;
  int object = -1;  ///< Index into the ModelLibrary.
  Rigid3 camera_from_object;
};

}  // namespace resight
