// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <span>

#include "resight/appearance/lab_color.hpp"

namespace resight {

/// Result of the comparison of two colour patterns at the same places.
struct PatternMatch {
  /// 1: equal patterns, or two untextured surfaces. About 0: different patterns, or only one is textured.
  double similarity = 1;
  /// Covariance of the patterns (not negative) relative to the variance that lighting, gloss and registration leave. 0
  /// if a pattern is untextured; the similarity is then weak evidence.
  double shared_texture = 0;
};

/// Similarity of two colour patterns, independent of brightness: the contrast and structure terms of the structural
/// similarity index (Wang et al. 2004), (2 cov + C) / (var_a + var_b + C), over all pairs of colours at the same place
/// and all three channels. `chroma_weight` weights a and b relative to l. The spans must have the same length (else
/// std::invalid_argument); empty ones give similarity 1.
[[nodiscard]] PatternMatch match_patterns(std::span<const LabColor> a, std::span<const LabColor> b,
                                          double chroma_weight);
/// Returns PatternMatch::similarity of match_patterns().
[[nodiscard]] double pattern_similarity(std::span<const LabColor> a, std::span<const LabColor> b, double chroma_weight);

}  // namespace resight
