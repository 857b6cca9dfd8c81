// SPDX-License-Identifier: Apache-2.0
#include "resight/registration/point_to_plane.hpp"

#include <gtest/gtest.h>

#include "resight/core/random.hpp"

namespace resight {
namespace {

TEST(BlockEquations, SumTheSameAsPairByPair) {
  constexpr double kRadius_m = 0.1;
  Rng rng(3);
  StepEquations one_by_one;
  BlockEquations blocks(kRadius_m);
  for (int block = 0; block < 20; ++block) {
    PairBlock pairs{};
    for (std::size_t k = 0; k < PairBlock::kSize; ++k) {
      if (k == 5) continue;  // No pair.
      Eigen::Vector3d arm, normal;
      for (int i = 0; i < 3; ++i) {
        arm[i] = rng.uniform(-0.1, 0.1);
        normal[i] = rng.uniform(-1, 1);
      }
      normal.normalize();
      const double residual = rng.uniform(-0.02, 0.02);
      const double weight = rng.uniform(0.1, 1);
      one_by_one.add(arm, normal, residual, weight, kRadius_m);
      for (std::size_t i = 0; i < 3; ++i) {
        pairs.arm[i][k] = static_cast<float>(arm[static_cast<Eigen::Index>(i)]);
        pairs.normal[i][k] = static_cast<float>(normal[static_cast<Eigen::Index>(i)]);
      }
      pairs.residual[k] = static_cast<float>(residual);
      pairs.weight[k] = static_cast<float>(weight);
    }
    blocks.add(pairs);
  }
  const StepEquations sum = blocks.sum();
  EXPECT_EQ(sum.num_pairs, 20 * 7);
  EXPECT_TRUE(sum.matrix.isApprox(one_by_one.matrix, 1e-5));
  EXPECT_TRUE(sum.right.isApprox(one_by_one.right, 1e-4));
  EXPECT_NEAR(sum.sum_weights, one_by_one.sum_weights, 1e-4);
  EXPECT_NEAR(sum.sum_residuals_sq, one_by_one.sum_residuals_sq, 1e-7);
}

}  // namespace
}  // namespace resight
