// SPDX-License-Identifier: Apache-2.0
#include "resight/shape_search/point_pair_table.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "resight/core/random.hpp"

namespace resight {
namespace {

constexpr double kMaxLength_m = 0.2;

Eigen::Vector3f random_direction(Rng& rng) {
  return Eigen::Vector3d{rng.normal(), rng.normal(), rng.normal()}.normalized().cast<float>();
}

OrientedPointPair random_point_pair(Rng& rng) {
  const Eigen::Vector3f p = 0.3F * random_direction(rng);
  return {p, random_direction(rng), p + static_cast<float>(rng.uniform(0.02, 0.19)) * random_direction(rng),
          random_direction(rng)};
}

OrientedPointPair moved(const Rigid3f& motion, const OrientedPointPair& d) {
  return {motion * d.p1, motion.rotation * d.n1, motion * d.p2, motion.rotation * d.n2};
}

Rigid3f random_motion(Rng& rng) {
  const double angle_rad = rng.uniform(0, 3.1);
  Rigid3 motion = Rigid3::from_axis_angle(random_direction(rng).cast<double>(), angle_rad);
  motion.translation = random_direction(rng).cast<double>();
  return Rigid3f(motion);
}

TEST(PointPairBin, DoesNotChangeWithTheFrame) {
  Rng rng(1);
  int same = 0;
  int num_bins = 0;
  for (int i = 0; i < 1000; ++i) {
    const OrientedPointPair d = random_point_pair(rng);
    const auto bin = point_pair_bin(d, kMaxLength_m);
    const auto other = point_pair_bin(moved(random_motion(rng), d), kMaxLength_m);
    if (!bin) continue;
    ++num_bins;
    EXPECT_LT(*bin, num_point_pair_bins(kMaxLength_m));
    if (other == bin) ++same;
  }
  EXPECT_GT(num_bins, 950);
  EXPECT_GE(same, num_bins - 3);  // Rounding at the border of a bin.
}

TEST(PointPairBin, DistinguishesAMirrorImage) {
  const OrientedPointPair d{{0, 0, 0}, {0, 1, 0}, {0.1F, 0, 0}, Eigen::Vector3f(0, 1, 1).normalized()};
  OrientedPointPair mirrored = d;
  mirrored.n2.z() = -mirrored.n2.z();
  EXPECT_NE(point_pair_bin(d, kMaxLength_m), point_pair_bin(mirrored, kMaxLength_m));
}

TEST(PointPairBin, PlanesAndLengthsOutOfRangeHaveNone) {
  const Eigen::Vector3f up(0, 0, 1);
  EXPECT_FALSE(point_pair_bin({{0, 0, 0}, up, {0.1F, 0, 0}, up}, kMaxLength_m));
  EXPECT_TRUE(point_pair_bin({{0, 0, 0}, up, {0.1F, 0, 0.1F}, up}, kMaxLength_m));  // A step.
  EXPECT_FALSE(point_pair_bin({{0, 0, 0}, up, {0.21F, 0, 0}, {1, 0, 0}}, kMaxLength_m));
  EXPECT_FALSE(point_pair_bin({{0, 0, 0}, up, {0.005F, 0, 0}, {1, 0, 0}}, kMaxLength_m));
  EXPECT_FALSE(point_pair_bin({{0, 0, 0}, up, {0, 0, 0}, {1, 0, 0}}, kMaxLength_m));
}

TEST(Align, MapsAnOrientedPointPairOntoItsImage) {
  Rng rng(2);
  int num_aligned = 0;
  for (int i = 0; i < 200; ++i) {
    const OrientedPointPair d = random_point_pair(rng);
    const Rigid3f motion = random_motion(rng);
    const auto found = align(d, moved(motion, d));
    if (!found) continue;
    ++num_aligned;
    EXPECT_LT((found->rotation - motion.rotation).cwiseAbs().maxCoeff(), 1e-3F);
    EXPECT_LT((found->translation - motion.translation).norm(), 1e-3F);
  }
  EXPECT_GT(num_aligned, 150);
}

TEST(Align, NormalsAlongTheLineFixNoPose) {
  const OrientedPointPair d{{0, 0, 0}, {1, 0, 0}, {0.1F, 0, 0}, {-1, 0, 0}};
  EXPECT_FALSE(align(d, d));
}

TEST(PointPairTable, HoldsEveryPairOfEachObjectInItsBin) {
  Rng rng(3);
  std::vector<std::vector<Eigen::Vector3f>> points(3);
  std::vector<std::vector<Eigen::Vector3f>> normals(3);
  std::vector<PointPairTable::Samples> samples;
  for (std::size_t o = 0; o < 3; ++o) {
    for (int i = 0; i < 25; ++i) {
      points[o].push_back(0.08F * random_direction(rng));
      normals[o].push_back(random_direction(rng));
    }
    samples.push_back({points[o], normals[o], 0.03, 0.1});
  }
  const PointPairTable table(samples);
  EXPECT_EQ(table.max_length_m(), 0.1);
  std::size_t num_pairs = 0;
  for (std::size_t o = 0; o < 3; ++o)
    for (std::uint16_t i = 0; i < 25; ++i)
      for (std::uint16_t j = 0; j < 25; ++j) {
        const double length = (points[o][i] - points[o][j]).norm();
        const auto bin = point_pair_bin({points[o][i], normals[o][i], points[o][j], normals[o][j]}, 0.1);
        if (i == j || length < 0.03 || length > 0.1 || !bin) continue;
        ++num_pairs;
        const auto entries = table.find(*bin);
        EXPECT_EQ(
            std::count_if(entries.begin(), entries.end(),
                          [&](const PointPairEntry& e) { return e.object == o && e.first == i && e.second == j; }),
            1);
        EXPECT_TRUE(
            std::is_sorted(entries.begin(), entries.end(),
                           [](const PointPairEntry& a, const PointPairEntry& b) { return a.object < b.object; }));
      }
  EXPECT_EQ(table.size(), num_pairs);
  EXPECT_GT(num_pairs, 500U);
}

TEST(PointPairTable, NoObjectsNoPairs) {
  EXPECT_EQ(PointPairTable(std::span<const PointPairTable::Samples>{}).size(), 0U);
}

}  // namespace
}  // namespace resight
