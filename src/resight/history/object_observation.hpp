// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "resight/geometry/rigid3.hpp"

namespace resight {

/// An object as one view shows it: all that the history needs of a detection.
struct ObjectObservation {
  int object = -1;  ///< Index into the ModelLibrary.
  Rigid3 world_from_object;
  double score = 0;            ///< Probability that the observation is right, in [0, 1].
  double confirmed_share = 1;  ///< Of the model's points, confirmed by the newest view itself.
};

}  // namespace resight
