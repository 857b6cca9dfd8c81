// SPDX-License-Identifier: Apache-2.0
#include "resight/registration/pose_uncertainty.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <cmath>

#include "resight/core/random.hpp"
#include "resight/verification/pose_refinement.hpp"
#include "resight/verification/scene_preparation.hpp"
#include "resight/verification/testing/analytic_scene.hpp"

namespace resight {
namespace {

using namespace analytic;

Eigen::Vector3d random_vector(Rng& rng) { return {rng.normal(), rng.normal(), rng.normal()}; }

constexpr double kRadius_m = 0.08;
constexpr double kSigma_m = 0.002;

// Points in all directions whose residuals are sensor noise.
StepEquations noisy_equations(std::uint64_t seed, int num_points) {
  Rng rng(seed);
  StepEquations equations;
  for (int i = 0; i < num_points; ++i) {
    const Eigen::Vector3d point = kRadius_m * random_vector(rng).normalized();
    const Eigen::Vector3d normal = random_vector(rng).normalized();
    equations.add(point, normal, kSigma_m * rng.normal(), 0.5, kRadius_m);
  }
  return equations;
}

// With the right covariance C of an estimate x of zero, x' C^-1 x is 6 on average.
TEST(PoseUncertainty, IsTheSpreadOfEstimates) {
  constexpr int kTrials = 300;
  double sum = 0;
  for (int trial = 0; trial < kTrials; ++trial) {
    const StepEquations equations = noisy_equations(static_cast<std::uint64_t>(trial), 60);
    Vector6 x = equations.matrix.ldlt().solve(equations.right);
    x.head<3>() /= kRadius_m;
    const PoseUncertainty u = pose_uncertainty(equations, kRadius_m, Eigen::Vector3d::Zero(), 1e-6, 0.015);
    ASSERT_TRUE(u.is_known());
    EXPECT_TRUE(u.free_directions.empty());
    sum += x.dot(u.covariance.ldlt().solve(x));
  }
  EXPECT_NEAR(sum / kTrials, 6, 1);
}

TEST(PoseUncertainty, OfAnotherPointIsWhatTheTwistMakesOfIt) {
  const Eigen::Vector3d d(0.05, -0.02, 0.1);
  const StepEquations equations = noisy_equations(1, 60);
  const auto here = pose_uncertainty(equations, kRadius_m, Eigen::Vector3d::Zero(), 1e-6, 0.015).covariance;
  const auto there = pose_uncertainty(equations, kRadius_m, d, 1e-6, 0.015).covariance;
  EXPECT_LT((there.topLeftCorner<3, 3>() - here.topLeftCorner<3, 3>()).norm(), 1e-12);
  Rng rng(2);
  for (int trial = 0; trial < 10; ++trial) {  // e . (shift + rotation x d) = e . shift + (d x e) . rotation
    const Eigen::Vector3d e = random_vector(rng);
    Vector6 row;
    row << d.cross(e), e;
    EXPECT_NEAR(e.dot(there.bottomRightCorner<3, 3>() * e), row.dot(here * row), 1e-12);
  }
}

TEST(PoseUncertainty, OfNothingIsNotKnown) {
  EXPECT_FALSE(pose_uncertainty({}, 1, Eigen::Vector3d::Zero(), 1e-3, 0.01).is_known());
  EXPECT_FALSE(pose_uncertainty(noisy_equations(1, 6), 1, Eigen::Vector3d::Zero(), 1e-3, 0.01).is_known());
  EXPECT_FALSE(PoseUncertainty{}.is_known());
}

// A single solid, seen from all sides.
PoseUncertainty of_solid(Shape shape, const Eigen::Vector3d& size, float min_normal_z = -2) {
  const Solid solid{shape, size, plain({200, 50, 40}), on_table(0, 0, 0.5 * size.z(), 0.3)};
  World world;
  world.solids = {solid};
  const VerifyOptions options;
  const PreparedModel model = prepare_model(make_model("solid", solid), options);
  const PreparedScene scene = prepare_scene(merge(render_all(world, circle_of_cameras(6))), options);
  std::vector<int> visible;
  for (std::size_t i = 0; i < model.points.size(); ++i)
    if (model.normals[i].z() > min_normal_z && model.normals[i].z() > -0.5F) visible.push_back(static_cast<int>(i));
  return estimate_pose_uncertainty(model, solid.world_from_object, visible, {}, scene);
}

TEST(EstimatePoseUncertainty, ABoxIsFixed) {
  const PoseUncertainty u = of_solid(Shape::kBox, {0.08, 0.06, 0.1});
  ASSERT_TRUE(u.is_known());
  EXPECT_TRUE(u.free_directions.empty());
  EXPECT_LT(std::sqrt(u.covariance.diagonal().maxCoeff()), 0.01);
  EXPECT_GT(u.covariance.diagonal().minCoeff(), 0);
}

TEST(EstimatePoseUncertainty, ACanRotatesAboutItsAxis) {
  const PoseUncertainty u = of_solid(Shape::kCylinder, {0.07, 0.07, 0.1});
  ASSERT_EQ(u.free_directions.size(), 1U);
  EXPECT_GT(std::abs(u.free_directions[0][2]), 0.95);
  EXPECT_GT(std::sqrt(u.covariance(2, 2)), 5 * std::sqrt(u.covariance(0, 0)));
}

TEST(EstimatePoseUncertainty, ABallRotatesAboutAllAxes) {
  const PoseUncertainty u = of_solid(Shape::kSphere, {0.08, 0.08, 0.08});
  ASSERT_EQ(u.free_directions.size(), 3U);
  for (const Vector6& direction : u.free_directions) EXPECT_GT(direction.head<3>().norm(), 0.9);
  EXPECT_LT(std::sqrt(u.covariance.bottomRightCorner<3, 3>().diagonal().maxCoeff()), 0.002);
}

TEST(EstimatePoseUncertainty, AFaceSlidesAndRotatesInItsPlane) {
  const PoseUncertainty u = of_solid(Shape::kBox, {0.08, 0.06, 0.1}, 0.9F);
  ASSERT_EQ(u.free_directions.size(), 3U);
  EXPECT_LT(std::sqrt(u.covariance(5, 5)), 0.003);  // Vertical.
  EXPECT_GT(std::sqrt(u.covariance(3, 3)), 0.005);  // Along the face.
}

}  // namespace
}  // namespace resight
