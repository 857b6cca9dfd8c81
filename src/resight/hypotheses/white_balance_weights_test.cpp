// SPDX-License-Identifier: Apache-2.0
#include "resight/hypotheses/white_balance_weights.hpp"

#include <gtest/gtest.h>

namespace resight {
namespace {

Hypothesis make_hypothesis(int object, std::size_t num_correspondences) {
  Hypothesis hypothesis;
  hypothesis.object = object;
  hypothesis.correspondences.resize(num_correspondences);
  return hypothesis;
}

TEST(WhiteBalanceWeights, AreTheCorrespondencesOfTheLargestHypothesisOfEachObject) {
  const std::vector<Hypothesis> hypotheses{make_hypothesis(2, 5), make_hypothesis(0, 354), make_hypothesis(2, 20),
                                           make_hypothesis(2, 20), make_hypothesis(1, 0)};
  EXPECT_EQ(white_balance_weights(hypotheses, 4), (std::vector<float>{0, 354, 20, 0, 0}));
  EXPECT_TRUE(white_balance_weights({}, 4).empty());
}

}  // namespace
}  // namespace resight
