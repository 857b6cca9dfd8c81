// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <span>
#include <vector>

#include "resight/hypotheses/hypothesis.hpp"

namespace resight {

/// How much each hypothesis has to say on the light of the scene (find_white_balance). Many agreeing keypoints are
/// seldom wrong, and a few dozen small groups mostly are: of each object the hypothesis with the most correspondences
/// votes, the first of equals, however often the object is taken for something like it. Each correspondence is one
/// vote, and no more: the colours of one object may tell the light wrongly, however many keypoints it has.
[[nodiscard]] std::vector<float> white_balance_weights(std::span<const Hypothesis> hypotheses, std::size_t num_models);

}  // namespace resight
