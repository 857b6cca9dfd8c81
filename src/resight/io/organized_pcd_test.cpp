// SPDX-License-Identifier: Apache-2.0
#include "resight/io/organized_pcd.hpp"

#include <gmock/gmock.h>

#include <cmath>

#include "resight/io/internal/test_data.hpp"

namespace resight {
namespace {

using testing::HasSubstr;

TEST(FitCamera, FindsTheCameraOfExactPoints) {
  const RgbdFrame frame = io::random_frame("a", 3, 96, 64);
  const PcdCloud cloud = to_pcd_cloud(frame);
  const auto fit = fit_camera(cloud.points, 96, 64);
  ASSERT_TRUE(fit.has_value());
  EXPECT_EQ(static_cast<std::size_t>(fit->num_points), count_valid(frame.depth_m));
  EXPECT_LT(fit->residual_px, 1e-3);
  EXPECT_NEAR(fit->camera.fx, frame.camera.fx, 1e-3);
  EXPECT_NEAR(fit->camera.fy, frame.camera.fy, 1e-3);
  EXPECT_NEAR(fit->camera.cx, frame.camera.cx, 1e-3);
  EXPECT_NEAR(fit->camera.cy, frame.camera.cy, 1e-3);
}

TEST(ToFrame, PrefersTheCommentAndIsExact) {
  const RgbdFrame frame = io::random_frame("view", 4);
  const auto back = to_frame(to_pcd_cloud(frame), "view");
  ASSERT_TRUE(back.ok()) << back.error().message;
  EXPECT_EQ(back->camera, frame.camera);
  EXPECT_EQ(back->color, frame.color);
  EXPECT_EQ(io::depth_difference_m(back->depth_m, frame.depth_m), 0);
  EXPECT_EQ(io::pose_difference(back->world_from_camera, frame.world_from_camera), 0);
}

TEST(ToFrame, NoPinholeGridIsAnError) {
  PcdCloud cloud = to_pcd_cloud(io::random_frame("view", 5));
  cloud.camera.reset();
  ASSERT_TRUE(to_frame(cloud, "view").ok());
  for (auto& p : cloud.points) p = {p.x() + p.y(), p.y(), p.z()};  // as if in the world frame
  const auto frame = to_frame(cloud, "view");
  ASSERT_FALSE(frame.ok());
  EXPECT_THAT(frame.error().message, HasSubstr("pinhole"));
}

TEST(ToFrame, NoPointsGiveTheKinectCamera) {
  PcdCloud cloud = to_pcd_cloud(io::random_frame("view", 6));
  cloud.camera.reset();
  for (auto& p : cloud.points) p.setZero();  // some writers store zeros for missing points
  const auto frame = to_frame(cloud, "view");
  ASSERT_TRUE(frame.ok());
  EXPECT_EQ(frame->camera, (Camera{48, 36, 525, 525, 23.5, 17.5}));
  EXPECT_EQ(count_valid(frame->depth_m), 0U);
}

TEST(ToFrame, BackwardCloudsAreRotatedAndStayInPlace) {
  const RgbdFrame frame = io::random_frame("view", 8);
  PcdCloud cloud = to_pcd_cloud(frame);
  cloud.camera.reset();
  for (auto& p : cloud.points) p = {p.x(), -p.y(), -p.z()};
  const auto turned = to_frame(cloud, "view");
  ASSERT_TRUE(turned.ok()) << turned.error().message;
  EXPECT_EQ(io::depth_difference_m(turned->depth_m, frame.depth_m), 0);
  // The world position of each point must not change.
  int num_points = 0;
  for (int v = 0; v < 36; ++v)
    for (int u = 0; u < 48; ++u) {
      if (std::isnan(frame.depth_m(u, v))) continue;
      const Eigen::Vector3d in_world = cloud.viewpoint * cloud.points[frame.depth_m.index(u, v)].cast<double>();
      const Eigen::Vector3d again = turned->world_from_camera * turned->camera.unproject(u, v, turned->depth_m(u, v));
      ASSERT_LT((in_world - again).norm(), 1e-4);
      ++num_points;
    }
  EXPECT_GT(num_points, 1000);
}

TEST(ToFrame, UnorganisedAndColourlessAreErrors) {
  PcdCloud cloud = to_pcd_cloud(io::random_frame("view", 6));
  cloud.width *= cloud.height;
  cloud.height = 1;
  EXPECT_THAT(to_frame(cloud, "v.pcd").error().message, HasSubstr("organised"));
  cloud = to_pcd_cloud(io::random_frame("view", 6));
  cloud.colors.clear();
  EXPECT_THAT(to_frame(cloud, "v.pcd").error().message, HasSubstr("colours"));
}

}  // namespace
}  // namespace resight
