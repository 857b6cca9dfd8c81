// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <span>
#include <string>
#include <vector>

#include "resight/annotation/annotation_document.hpp"
#include "resight/annotation/change_proposals.hpp"
#include "resight/models/object_model.hpp"

namespace resight {

/// Something that the annotator should look at.
struct AnnotationToDo {
  enum class Kind {
    kTwoPlaces,    ///< A track is at two places in one view.
    kGap,          ///< A track is nowhere for some views in between.
    kSamePlace,    ///< Two placements of one model are at the same place in one view.
    kUnexplained,  ///< No track explains a region that came or left, and nobody has judged it.
    kLostRegion,   ///< A region that somebody has judged is no longer proposed.
  };
  Kind kind = Kind::kTwoPlaces;
  int view = 0;                   ///< Where it shows.
  int track = -1;                 ///< -1: none.
  int region = -1;                ///< Index into the proposals; -1: none.
  std::string text;               ///< For the user.
  std::optional<RegionKey> lost;  ///< The region that is no longer proposed.
};

/// Whether the placements explain a region: one that begins at the region's view or before (novel), or ended before it
/// (removed), and whose surface holds most points of the region.
[[nodiscard]] bool is_region_explained(const AnnotationDocument& document, const ModelLibrary& library,
                                       const ChangeProposal& region);

/// All inconsistencies and open regions, in the order of their kinds and views.
[[nodiscard]] std::vector<AnnotationToDo> find_to_dos(const AnnotationDocument& document, const ModelLibrary& library,
                                                      std::span<const ChangeProposal> regions);

}  // namespace resight
