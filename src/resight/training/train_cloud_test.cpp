// SPDX-License-Identifier: Apache-2.0
// Tests training from a coloured cloud without faces.
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "resight/geometry/splat_mesh.hpp"
#include "resight/training/training.hpp"

namespace resight {
namespace {

using testing::HasSubstr;

constexpr double kRadius_m = 0.06;
const Eigen::Vector3d kCenter(0.01, -0.02, 0.05);

// Evenly spread (Fibonacci) points of a textured ball with blotches of three colours.
PointCloud make_ball(int count) {
  PointCloud ball;
  for (int i = 0; i < count; ++i) {
    const double z = 1 - (2 * i + 1.0) / count;
    const double phi = i * std::numbers::pi * (3.0 - std::sqrt(5.0));
    const double r = std::sqrt(1 - z * z);
    const Eigen::Vector3d n(r * std::cos(phi), r * std::sin(phi), z);
    ball.points.emplace_back((kCenter + kRadius_m * n).cast<float>());
    const double pattern = std::sin(11 * n.x() + 3 * n.y()) * std::sin(9 * n.y() - 5 * n.z()) * std::sin(13 * n.z());
    ball.colors.push_back(pattern > 0.1 ? Rgb8{220, 40, 30} : pattern < -0.1 ? Rgb8{20, 60, 200} : Rgb8{230, 225, 215});
  }
  return ball;
}

TrainOptions make_quick_options() {
  TrainOptions options;
  options.turntable.step_deg = 90;
  return options;
}

double distance_to_ball(const Eigen::Vector3f& p) { return std::abs((p.cast<double>() - kCenter).norm() - kRadius_m); }

TEST(TrainObjectFromCloud, SurfaceAndFeaturesLieOnTheBall) {
  const Result<ObjectModel> model = train_object("ball", make_ball(40000), make_quick_options());
  ASSERT_TRUE(model.ok()) << model.error().message;
  EXPECT_NEAR(model->diameter_m, 2 * kRadius_m, 0.001);
  EXPECT_LT((model->center.cast<double>() - kCenter).norm(), 0.001);
  EXPECT_GT(static_cast<double>(model->surface.size()), 0.95 * 4 * std::numbers::pi * std::pow(kRadius_m / 0.003, 2));
  for (std::size_t i = 0; i < model->surface.size(); ++i) {
    const Eigen::Vector3f& p = model->surface.points[i];
    ASSERT_LT(distance_to_ball(p), 5e-4);
    ASSERT_GT(model->surface.normals[i].cast<double>().dot((p.cast<double>() - kCenter).normalized()), 0.97);
  }
  EXPECT_GT(model->sift.size(), 100U);
  EXPECT_GT(model->shot.size(), 100U);
  for (const CodedFeatures* set : {&model->sift, &model->shot})
    for (const Eigen::Vector3f& p : set->points) ASSERT_LT(distance_to_ball(p), 0.003);
}

TEST(TrainObjectFromCloud, ViewsShowTheBallWithItsColours) {
  PointCloud ball = make_ball(40000);
  for (const Eigen::Vector3f& p : ball.points)
    ball.normals.emplace_back((p.cast<double>() - kCenter).normalized().cast<float>());
  TurntableOptions turntable;
  turntable.step_deg = 120;
  double red = 0;
  double blue = 0;
  for (const TrainingView& view : render_turntable(make_splat_mesh(ball), turntable)) {
    const Rigid3& world_from_camera = view.frame.world_from_camera;
    const Eigen::Vector3d center = world_from_camera.inverse() * kCenter;
    double num_pixels = 0;
    for (int v = 0; v < 480; ++v)
      for (int u = 0; u < 640; ++u) {
        if (view.mask(u, v) == 0) continue;
        ++num_pixels;
        const Eigen::Vector3d p = view.frame.camera.unproject(u, v, view.frame.depth_m(u, v));
        ASSERT_LT(std::abs((p - center).norm() - kRadius_m), 8e-4);
        const Rgb8 c = view.frame.color(u, v);
        red += c.r > 2 * c.b ? 1 : 0;
        blue += c.b > 2 * c.r ? 1 : 0;
      }
    // The image of a ball is a disc (tan^2 of its half angle).
    const double d = center.norm();
    const double tan_sq = kRadius_m * kRadius_m / (d * d - kRadius_m * kRadius_m);
    EXPECT_NEAR(num_pixels, std::numbers::pi * tan_sq * view.frame.camera.fx * view.frame.camera.fy, 0.04 * num_pixels);
  }
  EXPECT_GT(red, 10000);
  EXPECT_GT(blue, 10000);
}

TEST(TrainObjectFromCloud, GivenNormalsAreFlippedOutwards) {
  PointCloud ball = make_ball(20000);
  for (const Eigen::Vector3f& p : ball.points)
    ball.normals.emplace_back((kCenter - p.cast<double>()).normalized().cast<float>());
  const Result<PointCloud> surface = train_surface("ball", ball);
  ASSERT_TRUE(surface.ok()) << surface.error().message;
  for (std::size_t i = 0; i < surface->size(); ++i)
    ASSERT_GT(surface->normals[i].cast<double>().dot((surface->points[i].cast<double>() - kCenter).normalized()), 0.99);
}

// A label painted over a segmented cloud, or a default grey, does not describe what a camera sees.
TEST(TrainObjectFromCloud, WithoutColoursOrWithOneOnlyItsShapeCounts) {
  PointCloud ball = make_ball(20000);
  ball.colors.clear();
  const Result<ObjectModel> bare = train_object("ball", ball, make_quick_options());
  ASSERT_TRUE(bare.ok()) << bare.error().message;
  EXPECT_TRUE(bare->surface.colors.empty());
  EXPECT_EQ(bare->sift.size(), 0U);
  EXPECT_GT(bare->shot.size(), 100U);
  ball.colors.assign(ball.size(), Rgb8{0, 0, 255});
  const Result<ObjectModel> plain = train_object("ball", ball, make_quick_options());
  ASSERT_TRUE(plain.ok()) << plain.error().message;
  EXPECT_TRUE(plain->surface.colors.empty());
  EXPECT_EQ(plain->shot.points, bare->shot.points);
}

TEST(TrainObjectFromCloud, RefusesWhatIsNoObject) {
  const auto message = [](const PointCloud& cloud) {
    const Result<ObjectModel> model = train_object("ball", cloud);
    return model.ok() ? std::string("no error") : model.error().message;
  };
  EXPECT_THAT(message(make_ball(50)), HasSubstr("model 'ball': only 50 points"));
  PointCloud ball = make_ball(1000);
  ball.points[7].x() = std::numeric_limits<float>::quiet_NaN();
  EXPECT_THAT(message(ball), HasSubstr("not finite"));
  ball = make_ball(1000);
  for (Eigen::Vector3f& p : ball.points) p *= 1000;
  EXPECT_THAT(message(ball), HasSubstr("millimetres"));
  ball = make_ball(1000);
  for (Eigen::Vector3f& p : ball.points) p.setConstant(0.1F);
  ball.points[0].x() = 0.2F;
  EXPECT_THAT(message(ball), HasSubstr("coincide"));
}

}  // namespace
}  // namespace resight
