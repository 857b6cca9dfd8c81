// SPDX-License-Identifier: Apache-2.0
#include "resight/shape_search/silhouette.hpp"

#include <gtest/gtest.h>

namespace resight {
namespace {

std::vector<Eigen::Vector2f> disc(float radius_px, float spacing_px) {
  std::vector<Eigen::Vector2f> samples;
  for (float y = -radius_px; y <= radius_px; y += spacing_px)
    for (float x = -radius_px; x <= radius_px; x += spacing_px)
      if (x * x + y * y <= radius_px * radius_px) samples.emplace_back(200 + x, 100 + y);
  return samples;
}

TEST(Silhouette, IsWalkedAroundWithTheRimLeftOut) {
  constexpr float kRadius_px = 30;
  constexpr float kCell_px = 4;
  const auto samples = disc(kRadius_px, 2.5F);
  Silhouette silhouette(samples, kCell_px);
  for (const Eigen::Vector2f& p : samples) silhouette.set_known(p, 7);
  int cells = 0;
  silhouette.visit_around([&](const Eigen::Vector2f& px, int known) {
    EXPECT_EQ(known, 7);
    const float beyond_px = (px - Eigen::Vector2f(200, 100)).norm() - kRadius_px;
    EXPECT_GT(beyond_px, 0.5F * kCell_px);
    EXPECT_LT(beyond_px, 3 * kCell_px);
    ++cells;
    return true;
  });
  // One cell in each direction: the circumference in cells, the corners of the square grid included.
  EXPECT_GT(cells, 45);
  EXPECT_LT(cells, 100);
}

TEST(Silhouette, VisitsMoreUntilVisitReturnsTrue) {
  const auto samples = disc(10, 2);
  Silhouette silhouette(samples, 4);
  silhouette.visit_around([](const Eigen::Vector2f&, int) {
    ADD_FAILURE() << "nothing is known";
    return true;
  });
  for (std::size_t i = 0; i < samples.size(); ++i) silhouette.set_known(samples[i], static_cast<int>(i));
  int once = 0;
  silhouette.visit_around([&](const Eigen::Vector2f&, int) { return ++once > 0; });
  int all = 0;
  silhouette.visit_around([&](const Eigen::Vector2f&, int) { return ++all < 0; });
  EXPECT_GT(all, 2 * once);
}

TEST(Silhouette, OfOneSampleHasSixteenCellsAround) {
  const std::vector<Eigen::Vector2f> one{{0, 0}};
  Silhouette silhouette(one, 5);
  silhouette.set_known(one[0], 0);
  int cells = 0;
  silhouette.visit_around([&](const Eigen::Vector2f&, int) { return ++cells > 0; });
  EXPECT_EQ(cells, 16);
}

}  // namespace
}  // namespace resight
