// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <span>

#include "resight/appearance/lab_color.hpp"

namespace resight {

/// Two patterns of colour at the same places.
struct PatternMatch {
  double similarity = 1;      ///< 1: the same pattern, or two plain surfaces; about 0: unlike, or only one is plain.
  double shared_texture = 0;  ///< Covariance, in units of what light, gloss and registration leave; 0 for what is
                              ///< plain: then the similarity says little.
};

/// How alike two patterns of colour are, whatever the exposure: contrast and structure terms of the structural
/// similarity (Wang et al. 2004), (2 cov + C) / (var_a + var_b + C), over all pairs of colours at the same place and
/// all three channels. `chroma_weight`: of a and b beside l. Both spans of one length.
[[nodiscard]] PatternMatch match_patterns(std::span<const LabColor> a, std::span<const LabColor> b,
                                          double chroma_weight);
/// PatternMatch::similarity.
[[nodiscard]] double pattern_similarity(std::span<const LabColor> a, std::span<const LabColor> b, double chroma_weight);

}  // namespace resight
