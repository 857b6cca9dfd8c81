// SPDX-License-Identifier: Apache-2.0
#include "resight/geometry/fibonacci_sphere.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "resight/core/random.hpp"

namespace resight {
namespace {

TEST(FibonacciDirection, NoDirectionIsFarFromTheNext) {
  constexpr int kCount = 1000;
  // A lattice of equal areas has one direction per 4 pi / count, a disc of this radius.
  const double disc_rad = std::sqrt(4.0 / kCount);
  Rng rng(1);
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (int i = 0; i < kCount; ++i) {
    ASSERT_NEAR(fibonacci_direction(i, kCount).norm(), 1, 1e-12);
    sum += fibonacci_direction(i, kCount);
  }
  EXPECT_LT(sum.norm() / kCount, 1e-3);
  for (int trial = 0; trial < 200; ++trial) {
    const Eigen::Vector3d any = Eigen::Vector3d(rng.normal(), rng.normal(), rng.normal()).normalized();
    double cosine = -1;
    for (int i = 0; i < kCount; ++i) cosine = std::max(cosine, any.dot(fibonacci_direction(i, kCount)));
    EXPECT_LT(std::acos(std::min(1.0, cosine)), 1.7 * disc_rad);
  }
}

}  // namespace
}  // namespace resight
