// SPDX-License-Identifier: Apache-2.0
#include "resight/models/shape_symmetry_motions.hpp"

#include <algorithm>

#include "resight/geometry/symmetry.hpp"

namespace resight {

std::vector<Rigid3> shape_symmetry_motions(const ObjectModel& model, double max_step_rad) {
  std::vector<Rigid3> symmetry_motions = {Rigid3::identity()};
  if (!model.surface.has_colors() || model.shape_symmetries.continuous.size() > 1) return symmetry_motions;
  const double same_rad = 0.4 * max_step_rad;  // enumerate_symmetries() uses at least half of the largest step
  for (const Rigid3& motion : enumerate_symmetries(model.shape_symmetries, max_step_rad)) {
    const auto is_same = [&](const Rigid3& other) {
      return symmetric_rotation_distance_rad(motion, other, model.symmetries) < same_rad;
    };
    if (std::none_of(symmetry_motions.begin(), symmetry_motions.end(), is_same)) symmetry_motions.push_back(motion);
  }
  return symmetry_motions;
}

}  // namespace resight
