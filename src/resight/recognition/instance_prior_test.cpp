// SPDX-License-Identifier: Apache-2.0
#include "resight/recognition/instance_prior.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <random>

namespace resight {
namespace {

using Scores = std::vector<double>;

std::vector<Detection> detections_of(int object, const Scores& scores) {
  std::vector<Detection> detections;
  for (const double score : scores) {
    Detection& detection = detections.emplace_back();
    detection.object = object;
    detection.score = score;
  }
  return detections;
}

Scores scores_after(std::vector<Detection> detections, double further_instance_odds) {
  apply_instance_prior(detections, further_instance_odds);
  Scores scores;
  for (const Detection& detection : detections) scores.push_back(detection.score);
  return scores;
}

// The definition: a sum over all subsets.
Scores sum_over_subsets(const Scores& alone, double further_instance_odds) {
  Scores sums(alone.size(), 0);
  double total = 0;
  for (unsigned subset = 0; subset < 1U << alone.size(); ++subset) {
    double weight = 1;
    int num_right = 0;
    for (std::size_t i = 0; i < alone.size(); ++i) {
      const bool is_right = (subset >> i & 1U) != 0;
      weight *= is_right ? alone[i] : 1 - alone[i];
      num_right += is_right ? 1 : 0;
    }
    weight *= std::pow(further_instance_odds, std::max(0, num_right - 1));
    total += weight;
    for (std::size_t i = 0; i < alone.size(); ++i)
      if ((subset >> i & 1U) != 0) sums[i] += weight;
  }
  for (double& sum : sums) sum /= total;
  return sums;
}

TEST(InstancePrior, IsTheSumOverAllSubsets) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> probability(0.01, 0.999);
  for (int n = 1; n <= 6; ++n) {
    const double odds = probability(random);
    Scores alone;
    for (int i = 0; i < n; ++i) alone.push_back(probability(random));
    const Scores expected = sum_over_subsets(alone, odds);
    const Scores scores = scores_after(detections_of(0, alone), odds);
    for (std::size_t i = 0; i < alone.size(); ++i) EXPECT_NEAR(scores[i], expected[i], 1e-9) << n << " instances";
  }
}

TEST(InstancePrior, ASingleInstanceKeepsItsScore) {
  std::vector<Detection> detections = detections_of(0, {0.4});
  detections.push_back(detections_of(1, {1.0}).front());
  EXPECT_THAT(scores_after(detections, 0.1), testing::ElementsAre(0.4, 1.0));
}

TEST(InstancePrior, OddsOfOneChangeNothing) {
  EXPECT_THAT(scores_after(detections_of(0, {0.4, 0.9, 0}), 1),
              testing::Pointwise(testing::DoubleNear(1e-12), Scores{0.4, 0.9, 0}));
}

TEST(InstancePrior, ALookAlikeLosesMoreThanTheObject) {
  const Scores scores = scores_after(detections_of(0, {0.99, 0.7}), 0.1);
  EXPECT_GT(scores[0], 0.97);
  EXPECT_NEAR(scores[1], 0.203, 1e-3);
}

TEST(InstancePrior, CertainInstancesStayCertain) {
  for (const double score : scores_after(detections_of(0, Scores(1000, 1)), 1e-6)) EXPECT_NEAR(score, 1, 1e-5);
}

}  // namespace
}  // namespace resight
