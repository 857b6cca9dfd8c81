// SPDX-License-Identifier: Apache-2.0
#include "resight/core/disjoint_sets.hpp"

#include <gtest/gtest.h>

#include "resight/core/random.hpp"

namespace resight {
namespace {

// Against labels that are all rewritten at each join.
TEST(DisjointSets, RootsAreTheSmallestMembers) {
  constexpr int kSize = 60;
  Rng rng(1);
  DisjointSets sets(kSize);
  std::vector<int> labels(kSize);
  std::iota(labels.begin(), labels.end(), 0);
  for (int step = 0; step < kSize; ++step) {
    const auto a = static_cast<int>(rng.below(kSize)), b = static_cast<int>(rng.below(kSize));
    sets.join(a, b);
    const int low = std::min(labels[a], labels[b]), high = std::max(labels[a], labels[b]);
    std::ranges::replace(labels, high, low);
    for (int i = 0; i < kSize; ++i) ASSERT_EQ(sets.root(i), labels[i]) << "after " << step << " joins";
  }
}

}  // namespace
}  // namespace resight
