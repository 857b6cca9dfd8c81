// SPDX-License-Identifier: Apache-2.0
#include "resight/evaluation/reliability.hpp"

#include <cmath>

#include "resight/core/check.hpp"

namespace resight {

Reliability::Reliability() {
  for (const double from : {0.0, 0.25, 0.5, 0.75, 0.9, 0.95, 0.99}) bins_.push_back({.from = from});
}

void Reliability::add(double score, bool is_right) {
  check_in_range("score", score, 0, 1);
  std::size_t b = bins_.size() - 1;
  while (score < bins_[b].from) --b;
  ++(is_right ? bins_[b].right : bins_[b].wrong);
  bins_[b].sum_score += score;
}

double Reliability::calibration_error() const {
  double sum = 0;
  int count = 0;
  for (const ScoreBin& bin : bins_) {
    sum += std::abs(bin.sum_score - bin.right);
    count += bin.count();
  }
  return sum / count;
}

}  // namespace resight
