// SPDX-License-Identifier: Apache-2.0
#include "resight/simulation/camera_drift.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "resight/geometry/angle.hpp"

namespace resight {
namespace {

constexpr CameraDriftOptions kTracker{.position_sigma_m = 0.006, .rotation_sigma_deg = 0.3};

std::vector<Rigid3> long_path() {
  std::vector<Rigid3> path;
  for (int i = 0; i < 4000; ++i)
    path.push_back(Rigid3::from_axis_angle(Eigen::Vector3d::UnitZ(), 0.01 * i) *
                   Rigid3::from_translation({1, 0, 0.001 * i}));
  return path;
}

TEST(CameraDrift, HasTheWantedSizeAndIsCorrelated) {
  const std::vector<Rigid3> path = long_path();
  const std::vector<Rigid3> reported = drift_poses(path, kTracker);
  ASSERT_EQ(reported.size(), path.size());
  double position_sq = 0, rotation_sq = 0, step_sq = 0;
  for (std::size_t i = 1; i < path.size(); ++i) {
    ASSERT_TRUE(reported[i].is_rigid());
    const Eigen::Vector3d error = reported[i].translation - path[i].translation;
    const Eigen::Vector3d before = reported[i - 1].translation - path[i - 1].translation;
    position_sq += error.squaredNorm();
    step_sq += (error - before).squaredNorm();
    rotation_sq += std::pow(rotation_angle_rad(reported[i].rotation, path[i].rotation), 2);
  }
  const double count = static_cast<double>(path.size());
  EXPECT_NEAR(std::sqrt(position_sq / count), 0.006 * std::sqrt(3), 0.0012);
  EXPECT_NEAR(std::sqrt(rotation_sq / count), radians(0.3) * std::sqrt(3), radians(0.06));
  EXPECT_LT(step_sq, 0.5 * position_sq) << "neighbouring views must have similar errors";
}

TEST(CameraDrift, StartsAtTheTruthAndIsSeeded) {
  const std::vector<Rigid3> path = long_path();
  CameraDriftOptions options = kTracker;
  const std::vector<Rigid3> reported = drift_poses(path, options);
  EXPECT_EQ(reported[0].translation, path[0].translation);
  EXPECT_EQ(drift_poses(path, options)[7].translation, reported[7].translation);
  options.seed = 2;
  EXPECT_NE(drift_poses(path, options)[7].translation, reported[7].translation);
  EXPECT_EQ(drift_poses(path, {})[7].rotation, path[7].rotation);
}

}  // namespace
}  // namespace resight
