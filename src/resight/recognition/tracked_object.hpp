// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "resight/geometry/rigid3.hpp"

namespace resight {

/// An object that was not seen to leave its place.
struct TrackedObject {
  int track = -1;
  int object = -1;
  Rigid3 world_from_object;
  int last_view = -1;        ///< That it was recognised with.
  int seen_view = -1;        ///< Likewise, and that confirmed it itself.
  int since_view = -1;       ///< That it was first recognised with at its place.
  bool is_confirmed = true;  ///< False: it may well be something else (TentativeTracks).
};

}  // namespace resight
