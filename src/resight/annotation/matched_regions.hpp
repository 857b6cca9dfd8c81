// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <span>
#include <vector>

#include "resight/annotation/annotation_document.hpp"
#include "resight/annotation/change_proposals.hpp"

namespace resight {

/// Which decision is about which proposed region.
struct MatchedRegions {
  std::vector<const RegionJudgement*> of_proposal;  ///< One per proposal; null: nobody has decided.
  std::vector<const RegionJudgement*> unmatched;    ///< Their regions are no longer proposed.
};

/// Finds the decisions of proposals: those of the same view and kind whose centres are at most 2 cm or a quarter of the
/// region's longest side apart, the nearest pairs first. The document must outlive the result.
[[nodiscard]] MatchedRegions match_regions(const AnnotationDocument& document,
                                           std::span<const ChangeProposal> proposals);

}  // namespace resight
