// SPDX-License-Identifier: Apache-2.0
#include "resight/hypotheses/white_balance_weights.hpp"

namespace resight {

std::vector<float> white_balance_weights(std::span<const Hypothesis> hypotheses, std::size_t num_models) {
  const auto size = [&](int h) { return h < 0 ? 0 : hypotheses[h].correspondences.size(); };
  std::vector<int> voter(num_models, -1);
  for (int h = 0; h < static_cast<int>(hypotheses.size()); ++h)
    if (size(h) > size(voter[hypotheses[h].object])) voter[hypotheses[h].object] = h;
  std::vector<float> votes(hypotheses.size(), 0.0F);
  for (const int h : voter)
    if (h >= 0) votes[h] = static_cast<float>(size(h));
  return votes;
}

}  // namespace resight
