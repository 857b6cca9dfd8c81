// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "resight/geometry/rigid3.hpp"

namespace resight {

/// An object as one view shows it: all that the history needs of a detection.
struct ObjectObservation {
  int object = -1;  ///< Index into the ModelLibrary.
  Rigid3 world_from_object;
  double score = 0;            ///< Probability that the object is there, in [0, 1].
  double confirmed_share = 1;  ///< Of the model's points, confirmed by the newest view itself.
  double pose_score = 1;       ///< Probability of the pose, given that the object is there.
  /// Whether it is more likely than all other poses at the place.
  [[nodiscard]] bool is_pose_likely() const { return pose_score >= 0.5; }
};

}  // namespace resight
