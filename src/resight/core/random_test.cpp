// SPDX-License-Identifier: Apache-2.0
#include "resight/core/random.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <stdexcept>

namespace resight {
namespace {

// Values from an independent implementation of splitmix64 and PCG-XSH-RR. A change of them changes every seeded result.
TEST(Rng, GoldenValues) {
  const auto first_four = [](Rng rng) { return std::array{rng.next(), rng.next(), rng.next(), rng.next()}; };
  EXPECT_EQ(first_four(Rng(0)), (std::array<std::uint32_t, 4>{0x86f952fe, 0xd90e5468, 0x7209bdb6, 0x35c93874}));
  EXPECT_EQ(first_four(Rng(1)), (std::array<std::uint32_t, 4>{0x6a20f7c5, 0x6eee5ffd, 0x1068e889, 0x2884f824}));
  EXPECT_EQ(first_four(Rng::stream(1, 1)),
            (std::array<std::uint32_t, 4>{0xa7860fc4, 0x293cb10b, 0x1e1cfea3, 0xd721d09a}));
  EXPECT_EQ(first_four(Rng::stream(42, 7)),
            (std::array<std::uint32_t, 4>{0x1d7ad6ef, 0x437dba91, 0x99fa02b0, 0x2ae07876}));
}

TEST(Rng, UniformUsesAll53Bits) {
  Rng rng(1);
  EXPECT_EQ(rng.uniform(), 0x1.a883df15bbb96p-2);
  EXPECT_EQ(rng.uniform(), 0x1.068e8892884f8p-4);
}

TEST(Rng, StreamZeroIsTheSeedItself) {
  Rng a(9);
  Rng b = Rng::stream(9, 0);
  for (int i = 0; i < 100; ++i) ASSERT_EQ(a.next(), b.next());
}

TEST(Rng, UniformHasTheMomentsAndStaysInRange) {
  Rng rng(3);
  constexpr int kCount = 200000;
  double sum = 0;
  double sum_sq = 0;
  for (int i = 0; i < kCount; ++i) {
    const double x = rng.uniform();
    ASSERT_GE(x, 0.0);
    ASSERT_LT(x, 1.0);
    sum += x;
    sum_sq += x * x;
  }
  EXPECT_NEAR(sum / kCount, 0.5, 5 * std::sqrt(1.0 / 12 / kCount));
  EXPECT_NEAR(sum_sq / kCount, 1.0 / 3, 5 * std::sqrt(4.0 / 45 / kCount));
  const double in_range = rng.uniform(-3, -1);
  EXPECT_GE(in_range, -3);
  EXPECT_LT(in_range, -1);
}

TEST(Rng, NormalHasTheMoments) {
  Rng rng(4);
  constexpr int kCount = 200000;
  std::array<double, 4> moments{};
  int beyond_two = 0;
  for (int i = 0; i < kCount; ++i) {
    const double x = rng.normal();
    ASSERT_TRUE(std::isfinite(x));
    double power = 1;
    for (double& m : moments) m += (power *= x);
    beyond_two += std::abs(x) > 2 ? 1 : 0;
  }
  for (double& m : moments) m /= kCount;
  EXPECT_NEAR(moments[0], 0, 5.0 / std::sqrt(kCount));
  EXPECT_NEAR(moments[1], 1, 5.0 * std::sqrt(2.0 / kCount));
  EXPECT_NEAR(moments[2], 0, 5.0 * std::sqrt(15.0 / kCount));
  EXPECT_NEAR(moments[3], 3, 5.0 * std::sqrt(96.0 / kCount));
  EXPECT_NEAR(static_cast<double>(beyond_two) / kCount, 0.0455, 0.0025);
}

TEST(Rng, BelowIsUnbiased) {
  Rng rng(5);
  constexpr std::uint32_t kBound = 7;
  constexpr int kCount = 70000;
  std::array<int, kBound> histogram{};
  for (int i = 0; i < kCount; ++i) ++histogram.at(rng.below(kBound));
  double chi_sq = 0;
  for (const int n : histogram) chi_sq += (n - kCount / 7.0) * (n - kCount / 7.0) / (kCount / 7.0);
  EXPECT_LT(chi_sq, 27.9);  // 6 degrees of freedom, p = 0.0001
  for (int i = 0; i < 10; ++i) EXPECT_EQ(rng.below(1), 0U);
  EXPECT_THROW((void)rng.below(0), std::invalid_argument);
}

// With a bound of 3 * 2^30, a simple modulo would return the lower third of the numbers twice as often as the rest.
TEST(Rng, BelowRejectsTheIncompleteBlock) {
  Rng rng(6);
  constexpr std::uint32_t kBound = 3U << 30U;
  int low = 0;
  for (int i = 0; i < 30000; ++i) low += rng.below(kBound) < (1U << 30U) ? 1 : 0;
  EXPECT_NEAR(low, 10000, 400);
}

TEST(Rng, StreamsAreUncorrelated) {
  constexpr int kCount = 20000;
  for (std::uint64_t other = 1; other <= 20; ++other) {
    Rng a = Rng::stream(11, 0);
    Rng b = Rng::stream(11, other);
    double product = 0;
    for (int i = 0; i < kCount; ++i) product += (a.uniform() - 0.5) * (b.uniform() - 0.5);
    EXPECT_NEAR(product / kCount * 12, 0, 5.0 / std::sqrt(kCount)) << "stream " << other;
  }
}

TEST(Rng, FirstNumbersOfNeighbouringSeedsAndStreamsDiffer) {
  std::set<std::uint32_t> seen;
  for (std::uint64_t i = 0; i < 1000; ++i) {
    seen.insert(Rng(i).next());
    seen.insert(Rng::stream(123456, i).next());
  }
  EXPECT_GT(seen.size(), 1995U);  // 2,000 draws out of 2^32 collide with a probability of 0.05 %
}

TEST(Rng, ShufflePermutesEvenly) {
  std::array<std::array<int, 4>, 4> count{};  // [value][place]
  Rng rng(8);
  for (int round = 0; round < 12000; ++round) {
    std::vector<int> items{0, 1, 2, 3};
    rng.shuffle(items);
    for (int place = 0; place < 4; ++place) ++count.at(items.at(place)).at(place);
    std::ranges::sort(items);
    ASSERT_EQ(items, (std::vector<int>{0, 1, 2, 3}));
  }
  for (const auto& places : count)
    for (const int n : places) EXPECT_NEAR(n, 3000, 5 * std::sqrt(12000 * 0.25 * 0.75));
  std::vector<int> empty;
  rng.shuffle(empty);
  EXPECT_TRUE(empty.empty());
}

}  // namespace
}  // namespace resight
