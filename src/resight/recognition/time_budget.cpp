// SPDX-License-Identifier: Apache-2.0
#include "resight/recognition/time_budget.hpp"

#include <algorithm>
#include <utility>

namespace resight {
namespace {

constexpr std::size_t kMinHypotheses = 10;  // Verified in every view, so that late views recognise something, too.

}  // namespace

void TimeBudget::start_view() {
  if (deadline_ms_) deadline_ = Deadline(1e-3 * *deadline_ms_, clock_);
}

void TimeBudget::drop_late(std::vector<Hypothesis>& hypotheses, const IsTracked& is_tracked,
                           std::vector<std::string>& left_out) const {
  const double num_in_time = deadline_.left_s() / s_per_hypothesis_;
  const std::size_t num_all = hypotheses.size();
  if (num_in_time >= static_cast<double>(num_all)) return;
  const auto num_tracked = static_cast<std::size_t>(std::ranges::count_if(hypotheses, is_tracked));
  const std::size_t num_kept =
      std::min(num_all, std::max({num_tracked, kMinHypotheses, static_cast<std::size_t>(std::max(0.0, num_in_time))}));
  if (num_kept == num_all) return;
  std::ranges::stable_sort(hypotheses, std::greater<>(),
                           [&](const Hypothesis& h) { return std::pair(is_tracked(h), h.correspondences.size()); });
  hypotheses.resize(num_kept);
  left_out.push_back("verification of " + std::to_string(num_all - num_kept) + " of " + std::to_string(num_all) +
                     " hypotheses");
}

void TimeBudget::finish_verification(std::size_t num_hypotheses) {
  verification_s_ = clock_() - verification_start_s_;
  if (verification_s_ > 0 && num_hypotheses > 0)
    s_per_hypothesis_ = verification_s_ / static_cast<double>(num_hypotheses);
}

}  // namespace resight
