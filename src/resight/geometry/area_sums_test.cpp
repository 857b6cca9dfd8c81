// SPDX-License-Identifier: Apache-2.0
#include "resight/geometry/area_sums.hpp"

#include <gtest/gtest.h>

#include <Eigen/Core>

#include "resight/core/image.hpp"
#include "resight/core/random.hpp"

namespace resight {
namespace {

TEST(AreaSums, AreThoseOfTheCellsInTheGrid) {
  constexpr int kWidth = 13, kHeight = 9, kNumRectangles = 500;
  Rng rng(1);
  const auto draw = [&](int min, int max) { return static_cast<int>(rng.uniform(min, max)); };
  Image<int> values(kWidth, kHeight);
  for (int& value : values.data()) value = draw(-100, 100);
  const AreaSums<Eigen::Vector2i> sums(kWidth, kHeight, [&](int u, int v) { return Eigen::Vector2i(values(u, v), 1); });
  for (int n = 0; n < kNumRectangles; ++n) {
    const int left = draw(-5, kWidth + 5), top = draw(-5, kHeight + 5);
    const int right = left + draw(0, kWidth), bottom = top + draw(0, kHeight);
    Eigen::Vector2i expected = Eigen::Vector2i::Zero();
    for (int v = top; v <= bottom; ++v)
      for (int u = left; u <= right; ++u)
        if (u >= 0 && v >= 0 && u < kWidth && v < kHeight) expected += Eigen::Vector2i(values(u, v), 1);
    ASSERT_EQ(sums.sum(left, top, right, bottom), expected) << left << ' ' << top << ' ' << right << ' ' << bottom;
  }
}

}  // namespace
}  // namespace resight
