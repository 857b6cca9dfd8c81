// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <vector>

#include "resight/models/object_model.hpp"

namespace resight {

/// Motions of the object frame that leave the shape of an object unchanged, but not its colours. Only the texture
/// distinguishes poses that differ by one of them. The identity is first; motions about an axis are in steps of at most
/// `max_step_rad`. Returns only the identity for an object without colours, without such motions, or with the shape of
/// a ball, which has too many of them.
[[nodiscard]] std::vector<Rigid3> shape_symmetry_motions(const ObjectModel& model, double max_step_rad);

}  // namespace resight
