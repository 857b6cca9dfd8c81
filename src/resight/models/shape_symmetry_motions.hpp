// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <vector>

#include "resight/models/object_model.hpp"

namespace resight {

/// Motions of the object frame that leave an object's shape as it is but not its colours, the identity first: poses
/// that differ by one of them are told apart by the print alone. About an axis in steps of at most `max_step_rad`. Only
/// the identity for what has no colours or no such motion, and for a ball, which has too many of them to be tried.
[[nodiscard]] std::vector<Rigid3> shape_symmetry_motions(const ObjectModel& model, double max_step_rad);

}  // namespace resight
