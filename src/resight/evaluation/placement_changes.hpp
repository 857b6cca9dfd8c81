// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <span>
#include <vector>

#include "resight/evaluation/change_truth.hpp"
#include "resight/evaluation/change_visibility.hpp"
#include "resight/evaluation/placements.hpp"

namespace resight {

/// What the views of `sequence` show of each placement: of its end as the departure before view last_view + 1, and of
/// its beginning as the arrival before view first_view. Reads all views; fails with the error of the first that cannot
/// be read.
[[nodiscard]] Result<std::vector<ChangeVisibility>> observe_placements(std::span<const AnnotatedPlacement> placements,
                                                                       const std::vector<TruthView>& views,
                                                                       const Sequence& sequence,
                                                                       const ModelLibrary& library);

/// Changes that placements imply.
struct PlacementChanges {
  std::vector<TrueChange> changes;  ///< In order of views.
  /// Non-zero for each placement that its object has left: a view shows the place without it, or the same copy of the
  /// object is annotated elsewhere later.
  std::vector<char> has_left;
};

/// Derives the changes from placements and what the views show of them (one entry per placement).
///
/// A `.changes` file states neither what happened nor which placements are of one thing. A placement that ends or
/// begins has changed only if the views prove it: it may have left the image, or come into it. The same thing is
/// recognised by counting: there are as many copies of an object as placements overlap in time. A placement is the
/// continuation of an earlier one if all copies were seen before, or if the views prove both the departure and the
/// arrival. It is then a move if one moment between the views explains both, otherwise a removal and an addition.
/// `view` of a change is the earliest that the views allow.
[[nodiscard]] PlacementChanges infer_changes(std::span<const AnnotatedPlacement> placements,
                                             std::span<const ChangeVisibility> visibilities);

}  // namespace resight
