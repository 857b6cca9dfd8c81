// SPDX-License-Identifier: Apache-2.0
#include "resight/models/pose_distance.hpp"

#include "resight/core/check.hpp"

namespace resight {

PoseDifference compare_poses(const Rigid3& a_from_object, const Rigid3& reference_a_from_object,
                             const ObjectModel& model) {
  const Rigid3 nearest = nearest_symmetric_pose(a_from_object, reference_a_from_object, model.symmetries);
  return {center_distance_m(model, nearest, reference_a_from_object),
          rotation_angle_rad(nearest.rotation, reference_a_from_object.rotation)};
}

double center_distance_m(const ObjectModel& model, const Rigid3& a, const Rigid3& b) {
  const Eigen::Vector3d center = model.center.cast<double>();
  return (a * center - b * center).norm();
}

void SamePlaceOptions::check() const {
  check_positive("max_distance_m", max_distance_m);
  check_positive("max_rotation_rad", max_rotation_rad);
}

bool is_same_place(const ObjectModel& model, const Rigid3& a, const Rigid3& b, const SamePlaceOptions& options) {
  return is_same_place(model, model.symmetries, a, b, options);
}

bool is_same_place(const ObjectModel& model, const ObjectSymmetries& symmetries, const Rigid3& a, const Rigid3& b,
                   const SamePlaceOptions& options) {
  return center_distance_m(model, a, b) <= options.max_distance_m &&
         symmetric_rotation_distance_rad(a, b, symmetries) <= options.max_rotation_rad;
}

}  // namespace resight
