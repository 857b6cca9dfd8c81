// SPDX-License-Identifier: Apache-2.0
#include "resight/models/pose_distance.hpp"

#include "resight/core/check.hpp"

namespace resight {

void SamePlaceOptions::check() const {
  check_positive("max_distance_m", max_distance_m);
  check_positive("max_rotation_rad", max_rotation_rad);
}

bool is_same_place(const ObjectModel& model, const Rigid3& a, const Rigid3& b, const SamePlaceOptions& options) {
  const Eigen::Vector3d center = model.center.cast<double>();
  return (a * center - b * center).norm() <= options.max_distance_m &&
         symmetric_rotation_distance_rad(a, b, model.symmetries) <= options.max_rotation_rad;
}

}  // namespace resight
