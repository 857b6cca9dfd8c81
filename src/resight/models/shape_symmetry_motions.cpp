// SPDX-License-Identifier: Apache-2.0
#include "resight/models/shape_symmetry_motions.hpp"

#include <algorithm>

#include "resight/geometry/symmetry.hpp"

namespace resight {

std::vector<Rigid3> shape_turns(const ObjectModel& model, double max_step_rad) {
  std::vector<Rigid3> turns = {Rigid3::identity()};
  if (!model.surface.has_colors() || model.shape_symmetries.continuous.size() > 1) return turns;
  const double same_rad = 0.4 * max_step_rad;  // Steps are at least half of the largest.
  for (const Rigid3& turn : enumerate_symmetries(model.shape_symmetries, max_step_rad)) {
    const auto is_same = [&](const Rigid3& other) {
      return symmetric_rotation_distance_rad(turn, other, model.symmetries) < same_rad;
    };
    if (std::none_of(turns.begin(), turns.end(), is_same)) turns.push_back(turn);
  }
  return turns;
}

}  // namespace resight
