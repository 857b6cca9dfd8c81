// SPDX-License-Identifier: Apache-2.0
#include "resight/recognition/instance_prior.hpp"

#include <cmath>
#include <map>

#include "resight/core/odds.hpp"

namespace resight {

// With a = further_instance_odds, odds o_i = s_i / (1 - s_i) and A = the product of all 1 + a o_i, the terms of all
// subsets sum to 1 + (A - 1) / a, and those of the subsets with detection i to o_i A / (1 + a o_i).
void apply_instance_prior(std::vector<Detection>& detections, double further_instance_odds) {
  std::map<int, double> log_products;  // By object.
  std::map<int, int> num_instances;
  for (const Detection& detection : detections) {
    log_products[detection.object] += std::log1p(further_instance_odds * odds_of(detection.score));
    ++num_instances[detection.object];
  }
  for (Detection& detection : detections) {
    if (num_instances[detection.object] == 1) continue;
    const double further_odds = further_instance_odds * odds_of(detection.score);
    const double others = (1 - further_instance_odds) * std::exp(-log_products[detection.object]);
    detection.score = further_odds / (1 + further_odds) / (1 - others);
  }
}

}  // namespace resight
