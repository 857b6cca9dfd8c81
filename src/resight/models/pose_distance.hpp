// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "resight/geometry/symmetry.hpp"
#include "resight/models/object_model.hpp"

namespace resight {

/// Difference of two poses of one object.
struct PoseDifference {
  double center_distance_m = 0;
  double rotation_rad = 0;  ///< Smallest angle over the object's symmetries.
};

/// Compares two poses in the same frame a. Centres are compared after choosing the nearest symmetric equivalent, so
/// that a symmetry axis beside the centroid adds no distance.
[[nodiscard]] PoseDifference compare_poses(const Rigid3& a_from_object, const Rigid3& reference_a_from_object,
                                           const ObjectModel& model);

/// Between the centres (ObjectModel::center) of an object at two poses in the same frame.
[[nodiscard]] double center_distance_m(const ObjectModel& model, const Rigid3& a, const Rigid3& b);

/// Largest differences of two poses of an object that count as the same place.
struct SamePlaceOptions {
  double max_distance_m = 0.03;   ///< Between its centres.
  double max_rotation_rad = 0.2;  ///< Up to its symmetries.
  void check() const;
};

/// Whether two poses (a_from_object) place the object at the same place. The symmetries of its appearance count as
/// equal. Quick: center_distance_m() is compared first.
[[nodiscard]] bool is_same_place(const ObjectModel& model, const Rigid3& a, const Rigid3& b,
                                 const SamePlaceOptions& options);
/// With other symmetries than the model's, such as those of its shape alone.
[[nodiscard]] bool is_same_place(const ObjectModel& model, const ObjectSymmetries& symmetries, const Rigid3& a,
                                 const Rigid3& b, const SamePlaceOptions& options);

}  // namespace resight
