// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <span>

#include "resight/verification/lab_color.hpp"

namespace resight {

/// How alike two patterns of colour are, whatever the exposure: contrast and structure terms of the structural
/// similarity (Wang et al. 2004), (2 cov + C) / (var_a + var_b + C), over all pairs of colours at the same place and
/// all three channels. 1: the same pattern, or two plain surfaces; about 0: unlike, or one is plain and the other is
/// not. `chroma_weight`: of a and b beside l. 1 for no pairs. Both spans of one length.
[[nodiscard]] double pattern_similarity(std::span<const LabColor> a, std::span<const LabColor> b, double chroma_weight);

}  // namespace resight
