// SPDX-License-Identifier: Apache-2.0
#include "static_shares.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace resight::bench {
namespace {

constexpr double kBadShare = 0.01;

int range_of(float depth_m) {
  return std::min(static_cast<int>(depth_m / FalseShares::kRange_m), FalseShares::kNumRanges - 1);
}

std::string title_of_range(int range) {
  const double from_m = range * FalseShares::kRange_m;
  if (range == FalseShares::kNumRanges - 1) return fmt::format("from {:.1f} m", from_m);
  return fmt::format("{:.1f} to {:.1f} m", from_m, from_m + FalseShares::kRange_m);
}

}  // namespace

double FalseShares::add_view(const Image<float>& depth_m, const Mask& called) {
  Count of_view;
  for (std::size_t i = 0; i < depth_m.size(); ++i) {
    if (std::isnan(depth_m[i])) continue;
    const bool is_called = !called.empty() && called[i] != 0;
    of_view.add(is_called);
    by_range_[static_cast<std::size_t>(range_of(depth_m[i]))].add(is_called);
  }
  shares_.push_back(of_view.total > 0 ? of_view.share() : 0.0);
  return shares_.back();
}

double FalseShares::mean() const {
  if (shares_.empty()) return 0;
  return std::accumulate(shares_.begin(), shares_.end(), 0.0) / static_cast<double>(shares_.size());
}

double FalseShares::largest() const { return shares_.empty() ? 0 : *std::ranges::max_element(shares_); }

int FalseShares::num_bad_views() const {
  return static_cast<int>(std::ranges::count_if(shares_, [](double share) { return share > kBadShare; }));
}

void print_false_shares(const std::vector<std::pair<std::string, FalseShares>>& methods) {
  fmt::print("| called changed | mean per view | largest | views with more than 1 % |\n|---|---|---|---|\n");
  for (const auto& [method, shares] : methods)
    fmt::print("| {} | {:.2f} % | {:.2f} % | {} of {} |\n", method, 100 * shares.mean(), 100 * shares.largest(),
               shares.num_bad_views(), shares.num_views());
  fmt::print("\n| called changed, by range |");
  for (int range = 0; range < FalseShares::kNumRanges; ++range) fmt::print(" {} |", title_of_range(range));
  fmt::print("\n|---|");
  for (int range = 0; range < FalseShares::kNumRanges; ++range) fmt::print("---|");
  for (const auto& [method, shares] : methods) {
    fmt::print("\n| {} |", method);
    for (const Count& count : shares.by_range())
      fmt::print(" {} |", count.total > 0 ? fmt::format("{:.2f} %", 100 * count.share()) : "-");
  }
  fmt::print("\n");
}

}  // namespace resight::bench
