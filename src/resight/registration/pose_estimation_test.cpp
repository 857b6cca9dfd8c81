// SPDX-License-Identifier: Apache-2.0
#include "resight/registration/pose_estimation.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <stdexcept>

#include "resight/hypotheses/testing/synthetic_correspondences.hpp"

namespace resight {
namespace {

using testing::make_problem;
using testing::Problem;
using testing::random_pose;

struct Pairs {
  std::vector<Eigen::Vector3f> model;
  std::vector<Eigen::Vector3f> scene;
};

Pairs exact_pairs(Rng& rng, const Rigid3& pose, int n) {
  Pairs pairs;
  for (int i = 0; i < n; ++i) {
    const Eigen::Vector3d m{rng.uniform(-0.1, 0.1), rng.uniform(-0.1, 0.1), rng.uniform(-0.1, 0.1)};
    pairs.model.push_back(m.cast<float>());
    pairs.scene.push_back((pose * m.cast<float>().cast<double>().eval()).cast<float>());
  }
  return pairs;
}

double distance(const Rigid3& a, const Rigid3& b) { return (a.matrix() - b.matrix()).cwiseAbs().maxCoeff(); }

double sum_sq(const Pairs& pairs, const std::vector<double>& weights, const Rigid3& pose) {
  double sum = 0;
  for (std::size_t i = 0; i < pairs.model.size(); ++i)
    sum += weights[i] * (pose * pairs.model[i].cast<double>().eval() - pairs.scene[i].cast<double>()).squaredNorm();
  return sum;
}

TEST(FitRigid, RecoversExactMotions) {
  Rng rng(3);
  for (int trial = 0; trial < 50; ++trial) {
    const Rigid3 pose = random_pose(rng);
    const Pairs pairs = exact_pairs(rng, pose, 3 + trial % 10);
    const auto fit = fit_rigid(pairs.model, pairs.scene);
    ASSERT_TRUE(fit.has_value());
    EXPECT_TRUE(fit->is_rigid(1e-9));
    EXPECT_LT(distance(*fit, pose), trial % 10 == 0 ? 1e-4 : 5e-6) << trial;  // Random triangles may be slim.
  }
}

TEST(FitRigid, PlanarPairsGiveARotationNotAReflection) {
  Rng rng(4);
  const Rigid3 pose = random_pose(rng);
  Pairs pairs = exact_pairs(rng, pose, 12);
  for (std::size_t i = 0; i < pairs.model.size(); ++i) {
    pairs.model[i].z() = 0;
    pairs.scene[i] = (pose * pairs.model[i].cast<double>().eval()).cast<float>();
  }
  const auto fit = fit_rigid(pairs.model, pairs.scene);
  ASSERT_TRUE(fit.has_value());
  EXPECT_LT(distance(*fit, pose), 1e-5);
}

TEST(FitRigid, WeightedSolutionIsAMinimum) {
  Rng rng(5);
  Pairs pairs = exact_pairs(rng, random_pose(rng), 10);
  std::vector<double> weights;
  for (auto& p : pairs.scene) {
    p += 0.01F * Eigen::Vector3d{rng.normal(), rng.normal(), rng.normal()}.cast<float>();
    weights.push_back(rng.uniform(0.1, 2.0));
  }
  const auto fit = fit_rigid(pairs.model, pairs.scene, weights);
  ASSERT_TRUE(fit.has_value());
  const double best = sum_sq(pairs, weights, *fit);
  EXPECT_GT(best, 1e-6);
  for (int i = 0; i < 200; ++i) {
    Rigid3 step = Rigid3::from_axis_angle(testing::random_direction(rng), 1e-3);
    step.translation = 1e-4 * testing::random_direction(rng);
    EXPECT_GE(sum_sq(pairs, weights, *fit * step), best);
  }
}

TEST(FitRigid, AWeightOfZeroOrANanPairDoesNotCount) {
  Rng rng(6);
  const Rigid3 pose = random_pose(rng);
  Pairs pairs = exact_pairs(rng, pose, 8);
  pairs.scene[2] += Eigen::Vector3f(1, 2, 3);
  pairs.scene[5].x() = std::numeric_limits<float>::quiet_NaN();
  std::vector<double> weights(8, 1.0);
  weights[2] = 0;
  const auto fit = fit_rigid(pairs.model, pairs.scene, weights);
  ASSERT_TRUE(fit.has_value());
  EXPECT_LT(distance(*fit, pose), 5e-6);
}

TEST(FitRigid, DegeneratePairsGiveNone) {
  Rng rng(7);
  const Rigid3 pose = random_pose(rng);
  EXPECT_FALSE(fit_rigid({}, {}).has_value());
  const Pairs two = exact_pairs(rng, pose, 2);
  EXPECT_FALSE(fit_rigid(two.model, two.scene).has_value());
  Pairs line;
  for (int i = 0; i < 9; ++i) {
    const Eigen::Vector3d m = Eigen::Vector3d(0.01, 0.02, -0.005) * i + Eigen::Vector3d(0.3, 0.1, 0.2);
    line.model.push_back(m.cast<float>());
    line.scene.push_back((pose * m).cast<float>());
  }
  EXPECT_FALSE(fit_rigid(line.model, line.scene).has_value());
  const Pairs point{std::vector<Eigen::Vector3f>(5, Eigen::Vector3f(1, 2, 3)),
                    std::vector<Eigen::Vector3f>(5, Eigen::Vector3f(0, 1, 0))};
  EXPECT_FALSE(fit_rigid(point.model, point.scene).has_value());
}

TEST(FitRigid, RejectsBadArguments) {
  const std::vector<Eigen::Vector3f> three(3, Eigen::Vector3f::Zero());
  const std::vector<Eigen::Vector3f> two(2, Eigen::Vector3f::Zero());
  EXPECT_THROW((void)fit_rigid(three, two), std::invalid_argument);
  EXPECT_THROW((void)fit_rigid(three, three, std::vector<double>{1, 1}), std::invalid_argument);
  EXPECT_THROW((void)fit_rigid(three, three, std::vector<double>{1, -1, 1}), std::invalid_argument);
}

TEST(EstimatePose, ExactCorrespondencesGiveThePose) {
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const Problem problem = make_problem(
        {.num_correspondences = 20, .inliers_per_instance = 20, .noise_m = 0, .normal_noise_rad = 0, .seed = seed});
    const auto estimate = estimate_pose(problem.correspondences);
    ASSERT_TRUE(estimate.has_value());
    EXPECT_EQ(estimate->inliers.size(), 20U);
    EXPECT_LT(estimate->rms_m, 1e-6);
    const Rigid3& truth = problem.scene_from_object[0];
    EXPECT_LT((estimate->scene_from_model.translation - truth.translation).norm(), 1e-6);
    EXPECT_LT(rotation_angle_rad(estimate->scene_from_model.rotation, truth.rotation), 1e-5);
  }
}

TEST(EstimatePose, FindsThePoseAmongOutliers) {
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const Problem problem = make_problem({.num_correspondences = 100, .inliers_per_instance = 30, .seed = seed});
    const auto estimate = estimate_pose(problem.correspondences);
    ASSERT_TRUE(estimate.has_value());
    EXPECT_TRUE(testing::is_near(estimate->scene_from_model, problem.scene_from_object[0], 0.005, 0.05)) << seed;
    int num_right = 0;
    for (const int i : estimate->inliers) num_right += problem.instance[static_cast<std::size_t>(i)] == 0 ? 1 : 0;
    EXPECT_GE(num_right, 28);
    EXPECT_LE(estimate->inliers.size(), 36U);
    EXPECT_TRUE(std::is_sorted(estimate->inliers.begin(), estimate->inliers.end()));
  }
}

TEST(EstimatePose, InliersAreThoseThatTheDocumentationNames) {
  const Problem problem = make_problem({.num_correspondences = 200, .inliers_per_instance = 60, .seed = 8});
  const EstimatePoseOptions options;
  const auto estimate = estimate_pose(problem.correspondences, options);
  ASSERT_TRUE(estimate.has_value());
  std::vector<int> expected;
  for (std::size_t i = 0; i < problem.correspondences.size(); ++i) {
    const Correspondence& c = problem.correspondences[i];
    const Eigen::Vector3d moved = estimate->scene_from_model * c.model_point.cast<double>().eval();
    const Eigen::Vector3d normal = estimate->scene_from_model.rotation * c.model_normal.cast<double>();
    if ((moved - c.scene_point.cast<double>()).norm() <= options.inlier_distance_m &&
        std::acos(normal.dot(c.scene_normal.cast<double>())) <= options.max_normal_angle_rad)
      expected.push_back(static_cast<int>(i));
  }
  EXPECT_GT(expected.size(), 40U);
  EXPECT_EQ(estimate->inliers, expected);
}

TEST(EstimatePose, NormalsThatDisagreeAreNoInliers) {
  Problem problem = make_problem({.num_correspondences = 20, .inliers_per_instance = 20, .noise_m = 0, .seed = 9});
  for (auto& c : problem.correspondences) c.scene_normal = -c.scene_normal;
  EXPECT_FALSE(estimate_pose(problem.correspondences).has_value());
  for (auto& c : problem.correspondences) c.scene_normal.setConstant(std::numeric_limits<float>::quiet_NaN());
  const auto unmeasured = estimate_pose(problem.correspondences);
  ASSERT_TRUE(unmeasured.has_value());
  EXPECT_EQ(unmeasured->inliers.size(), 20U);
}

TEST(EstimatePose, NothingToFindGivesNone) {
  EXPECT_FALSE(estimate_pose({}).has_value());
  const Problem outliers = make_problem({.num_correspondences = 60, .inliers_per_instance = 0, .seed = 10});
  EXPECT_FALSE(estimate_pose(outliers.correspondences, {.min_inliers = 12}).has_value());
  Problem line = make_problem({.num_correspondences = 20, .inliers_per_instance = 20, .noise_m = 0, .seed = 11});
  for (std::size_t i = 0; i < 20; ++i) {
    line.correspondences[i].model_point = Eigen::Vector3f(0.01F * static_cast<float>(i), 0, 0);
    line.correspondences[i].scene_point = Eigen::Vector3f(0, 0.01F * static_cast<float>(i), 1);
  }
  EXPECT_FALSE(estimate_pose(line.correspondences).has_value());
}

TEST(EstimatePose, NanPointsAreLeftOut) {
  Problem problem = make_problem({.num_correspondences = 40, .inliers_per_instance = 30, .seed = 12});
  const float nan = std::numeric_limits<float>::quiet_NaN();
  problem.correspondences[0].model_point.x() = nan;
  problem.correspondences[1].scene_point.setConstant(nan);
  const auto estimate = estimate_pose(problem.correspondences);
  ASSERT_TRUE(estimate.has_value());
  EXPECT_TRUE(testing::is_near(estimate->scene_from_model, problem.scene_from_object[0]));
  EXPECT_GT(estimate->inliers.front(), 1);
  for (auto& c : problem.correspondences) c.scene_point.z() = nan;
  EXPECT_FALSE(estimate_pose(problem.correspondences).has_value());
}

TEST(EstimatePose, SmallGroupsAreSearchedCompletely) {
  // Five of twelve agree: 10 of 220 triples are right, and min_inliers tolerates no missed inlier.
  for (std::uint64_t seed = 0; seed < 30; ++seed) {
    const Problem problem = make_problem(
        {.num_correspondences = 12, .inliers_per_instance = 5, .noise_m = 0.0005, .normal_noise_rad = 0, .seed = seed});
    EXPECT_TRUE(estimate_pose(problem.correspondences).has_value()) << seed;
  }
}

TEST(EstimatePose, SameSeedSameBytes) {
  const Problem problem = make_problem({.num_correspondences = 150, .inliers_per_instance = 30, .seed = 13});
  const auto a = estimate_pose(problem.correspondences, {.seed = 5});
  const auto b = estimate_pose(problem.correspondences, {.seed = 5});
  ASSERT_TRUE(a && b);
  EXPECT_EQ(a->scene_from_model.matrix(), b->scene_from_model.matrix());
  EXPECT_EQ(a->inliers, b->inliers);
}

TEST(RefinePose, ConvergesFromADisturbedStart) {
  const Problem problem = make_problem({.num_correspondences = 60, .inliers_per_instance = 50, .seed = 14});
  Rigid3 start = problem.scene_from_object[0] * Rigid3::from_axis_angle(Eigen::Vector3d(1, 1, 0), 0.05);
  start.translation.x() += 0.005;
  const auto refined = refine_pose(problem.correspondences, start);
  ASSERT_TRUE(refined.has_value());
  EXPECT_TRUE(testing::is_near(refined->scene_from_model, problem.scene_from_object[0], 0.003, 0.03));
  EXPECT_GT(refined->inliers.size(), 44U);
  start.translation.x() += 1.0;
  EXPECT_FALSE(refine_pose(problem.correspondences, start).has_value());
}

TEST(RefinePose, WhatItReturnsStands) {
  int num_moved = 0;
  for (std::uint64_t seed = 0; seed < 30; ++seed) {
    const Problem problem =
        make_problem({.num_correspondences = 80, .inliers_per_instance = 50, .noise_m = 0.006, .seed = seed});
    Rigid3 start = problem.scene_from_object[0] * Rigid3::from_axis_angle(Eigen::Vector3d(1, 1, 0), 0.08);
    start.translation.x() += 0.008;
    const auto refined = refine_pose(problem.correspondences, start);
    ASSERT_TRUE(refined.has_value());
    const auto again = refine_pose(problem.correspondences, refined->scene_from_model);
    ASSERT_TRUE(again.has_value());
    // A pair at the very limit may change sides within the convergence tolerance.
    std::vector<int> changed;
    std::set_symmetric_difference(again->inliers.begin(), again->inliers.end(), refined->inliers.begin(),
                                  refined->inliers.end(), std::back_inserter(changed));
    EXPECT_LE(changed.size(), 1U) << seed;
    EXPECT_LT((again->scene_from_model.translation - refined->scene_from_model.translation).norm(), 5e-4);
    num_moved += (refined->scene_from_model.translation - start.translation).norm() > 0.004 ? 1 : 0;
  }
  EXPECT_GT(num_moved, 20);
}

TEST(EstimatePoseOptions, RejectsNonsense) {
  EXPECT_THROW((EstimatePoseOptions{.inlier_distance_m = 0}).check(), std::invalid_argument);
  EXPECT_THROW((EstimatePoseOptions{.max_normal_angle_rad = std::nan("")}).check(), std::invalid_argument);
  EXPECT_THROW((EstimatePoseOptions{.max_iterations = 0}).check(), std::invalid_argument);
  EXPECT_THROW((EstimatePoseOptions{.min_inliers = 2}).check(), std::invalid_argument);
  EXPECT_NO_THROW(EstimatePoseOptions{}.check());
}

}  // namespace
}  // namespace resight
