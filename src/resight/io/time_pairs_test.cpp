// SPDX-License-Identifier: Apache-2.0
#include "resight/io/internal/time_pairs.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

#include "resight/core/random.hpp"

namespace resight::io {

bool operator==(const TimePair& a, const TimePair& b) { return a.color == b.color && a.depth == b.depth; }
std::ostream& operator<<(std::ostream& out, const TimePair& pair) { return out << pair.color << '-' << pair.depth; }

namespace {

using testing::ElementsAre;
using testing::IsEmpty;

/// Takes the nearest of all pairs that are left, again and again.
std::vector<TimePair> pair_by_force(std::span<const double> colors_s, std::span<const double> depths_s,
                                    double max_gap_s) {
  std::vector<std::tuple<double, std::size_t, std::size_t>> all;
  for (std::size_t c = 0; c < colors_s.size(); ++c)
    for (std::size_t d = 0; d < depths_s.size(); ++d) all.emplace_back(std::abs(colors_s[c] - depths_s[d]), c, d);
  std::ranges::sort(all);
  std::vector<bool> color_is_taken(colors_s.size());
  std::vector<bool> depth_is_taken(depths_s.size());
  std::vector<TimePair> pairs;
  for (const auto& [gap_s, c, d] : all) {
    if (gap_s > max_gap_s || color_is_taken[c] || depth_is_taken[d]) continue;
    color_is_taken[c] = depth_is_taken[d] = true;
    pairs.push_back({c, d});
  }
  std::ranges::sort(pairs, {}, [&](const TimePair& pair) { return std::pair(colors_s[pair.color], pair.color); });
  return pairs;
}

TEST(PairByTime, IsWhatTryingAllPairsFinds) {
  Rng rng(7);
  for (int round = 0; round < 200; ++round) {
    std::vector<double> colors_s(rng.below(13));
    std::vector<double> depths_s(rng.below(13));
    for (double& time_s : colors_s) time_s = rng.uniform(0, 0.3);
    for (double& time_s : depths_s) time_s = rng.uniform(0, 0.3);
    EXPECT_EQ(pair_by_time(colors_s, depths_s, 0.05), pair_by_force(colors_s, depths_s, 0.05)) << round;
  }
}

// Headers may have no time at all, or whole seconds.
TEST(PairByTime, ImagesOfOneTimeArePairedInTheirOrder) {
  Rng rng(8);
  for (int round = 0; round < 200; ++round) {
    std::vector<double> colors_s(rng.below(13));
    std::vector<double> depths_s(rng.below(13));
    for (double& time_s : colors_s) time_s = static_cast<double>(rng.below(3));
    for (double& time_s : depths_s) time_s = static_cast<double>(rng.below(3));
    EXPECT_EQ(pair_by_time(colors_s, depths_s, 0.05), pair_by_force(colors_s, depths_s, 0.05)) << round;
  }
  const std::vector<double> unset_s(3, 0.0);
  EXPECT_THAT(pair_by_time(unset_s, unset_s, 0.02), ElementsAre(TimePair{0, 0}, TimePair{1, 1}, TimePair{2, 2}));
}

// A colour image that is a little nearer to the depth image of another one must not take it.
TEST(PairByTime, TwoColorImagesPerDepthImageLeaveTheNearerOne) {
  EXPECT_THAT(pair_by_time(std::vector{0.0, 0.016, 0.033, 0.050}, std::vector{0.014, 0.048}, 0.02),
              ElementsAre(TimePair{1, 0}, TimePair{3, 1}));
}

TEST(PairByTime, UnsortedTimesGivePairsInTheOrderOfColors) {
  EXPECT_THAT(pair_by_time(std::vector{2.0, 0.0, 1.0}, std::vector{1.01, 2.01, 0.01}, 0.02),
              ElementsAre(TimePair{1, 2}, TimePair{2, 0}, TimePair{0, 1}));
}

TEST(PairByTime, TimesThatAreNotFiniteBelongToNoPair) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  constexpr double kInf = std::numeric_limits<double>::infinity();
  EXPECT_THAT(pair_by_time(std::vector{kNan, 1.0, kInf}, std::vector{kInf, kNan, 1.0}, 1), ElementsAre(TimePair{1, 2}));
  EXPECT_THAT(pair_by_time(std::vector{1e308}, std::vector{-1e308}, 1), IsEmpty());
  EXPECT_THAT(pair_by_time({}, {}, 1), IsEmpty());
}

// A hostile list must not cost the square of its length.
TEST(PairByTime, ManyImagesOfOneTimeArePaired) {
  const std::vector<double> same_s(200'000, 5.0);
  EXPECT_EQ(pair_by_time(same_s, same_s, 1).size(), same_s.size());
}

}  // namespace
}  // namespace resight::io
