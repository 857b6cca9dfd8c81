// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "resight/models/object_model.hpp"

namespace resight {

/// Largest differences of two poses of an object that count as the same place.
struct SamePlaceOptions {
  double max_distance_m = 0.03;   ///< Between its centres.
  double max_rotation_rad = 0.2;  ///< Up to its symmetries.
  void check() const;
};

/// Whether two poses (a_from_object) place the object at the same place. The symmetries of its appearance count as
/// equal.
[[nodiscard]] bool is_same_place(const ObjectModel& model, const Rigid3& a, const Rigid3& b,
                                 const SamePlaceOptions& options);

}  // namespace resight
