// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "resight/evaluation/ghosts.hpp"
#include "resight/io/tuw_changes.hpp"

namespace resight {

/// An object at one place, from the first to the last annotation of its `.changes` chain. Between them it may be out of
/// the image.
struct AnnotatedPlacement {
  std::string object;
  int first_view = 0;
  int last_view = 0;
  Rigid3 first_world_from_object;  ///< By the annotation of the first view.
  Rigid3 last_world_from_object;   ///< By the annotation of the last view.
};

/// Looks up the poses of the placements of library objects. The error names `name` and the annotation that a view does
/// not have. Throws std::invalid_argument for a view that does not exist.
[[nodiscard]] Result<std::vector<AnnotatedPlacement>> locate_placements(const std::vector<ObjectPlacement>& placements,
                                                                        std::span<const TruthView> views,
                                                                        const ModelLibrary& library,
                                                                        std::string_view name);

/// A former place for every placement that ends before the last view, in the same order: the pose of the last
/// annotation, in all later views. This is the truth that the published `create_penalties` writes for Fig. 5 of the
/// paper. `has_left` (one entry per placement): whether the place is proven to be left (PlacementChanges).
[[nodiscard]] std::vector<FormerPlace> penalized_places(std::span<const AnnotatedPlacement> placements,
                                                        std::span<const char> has_left, int num_views);

}  // namespace resight
