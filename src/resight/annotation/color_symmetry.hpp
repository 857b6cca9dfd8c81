// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <span>

#include "resight/annotation/refine_over_views.hpp"

namespace resight {

/// Which of the poses that depth does not tell apart are tried.
enum class SymmetrySearch {
  kNear,  ///< Rotations by up to 6 deg about an axis of the object's shape.
  kAll,   ///< All symmetries of its shape.
};

/// Depth does not tell poses apart that differ by a symmetry of the object's shape, such as the rotation of a can. Of
/// these poses, this is the one whose colours fit the views best; about an axis, to a fraction of a degree. The given
/// pose if the shape has no symmetries or the model no colours. Views without enough of the object do not count.
[[nodiscard]] Rigid3 resolve_symmetry_by_color(const ObjectModel& model, double surface_voxel_m,
                                               const Rigid3& world_from_object, std::span<const NumberedView> views,
                                               SymmetrySearch search);

}  // namespace resight
