// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <vector>

namespace resight::viewer {

/// Maps numbers of views in results to numbers in their sequence. They differ where a run has skipped views.
class SequenceNumbers {
 public:
  SequenceNumbers() = default;
  /// `stored_views`: per view of the sequence, its number in the results, or -1.
  explicit SequenceNumbers(const std::vector<int>& stored_views) {
    for (std::size_t v = 0; v < stored_views.size(); ++v) {
      if (stored_views[v] < 0) continue;
      const auto stored = static_cast<std::size_t>(stored_views[v]);
      if (stored >= numbers_.size()) numbers_.resize(stored + 1, -1);
      numbers_[stored] = static_cast<int>(v);
    }
  }
  /// -1 for what is no view of the results.
  [[nodiscard]] int of(int stored) const {
    const auto index = static_cast<std::size_t>(stored);
    return stored >= 0 && index < numbers_.size() ? numbers_[index] : -1;
  }

 private:
  std::vector<int> numbers_;
};

}  // namespace resight::viewer
