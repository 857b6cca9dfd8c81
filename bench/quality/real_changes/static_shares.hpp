// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <string>
#include <utility>
#include <vector>

#include "change_scores.hpp"

namespace resight::bench {

/// Shares of pixels with depth that are called changed in a static scene, where this is always false.
class FalseShares {
 public:
  /// An empty mask calls nothing changed. Returns the share of this view.
  double add_view(const Image<float>& depth_m, const Mask& called);
  /// Mean over the views.
  [[nodiscard]] double mean() const;
  [[nodiscard]] double largest() const;
  [[nodiscard]] int num_views() const { return static_cast<int>(shares_.size()); }
  /// Views of which more than 1 % is called changed.
  [[nodiscard]] int num_bad_views() const;

  static constexpr int kNumRanges = 8;
  static constexpr double kRange_m = 0.5;
  /// By depth of the pixel. The last range is open.
  [[nodiscard]] const std::array<Count, kNumRanges>& by_range() const { return by_range_; }

 private:
  std::vector<double> shares_;  // By view.
  std::array<Count, kNumRanges> by_range_{};
};

/// Prints two tables with a row per method: shares per view and shares by range.
void print_false_shares(const std::vector<std::pair<std::string, FalseShares>>& methods);

}  // namespace resight::bench
