// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <span>
#include <vector>

#include "resight/hypotheses/hypothesis.hpp"

namespace resight {

/// Weight of each hypothesis in the vote on the illumination of the scene (find_white_balance). Large groups of
/// agreeing keypoints are rarely wrong, whereas most small groups are. Therefore, only the hypothesis with the most
/// correspondences votes per object (the first in a tie). Its weight is the number of its correspondences; all other
/// weights are 0.
[[nodiscard]] std::vector<float> white_balance_weights(std::span<const Hypothesis> hypotheses, std::size_t num_models);

}  // namespace resight
