// SPDX-License-Identifier: Apache-2.0
#include "resight/sensor/prepared_view.hpp"

#include <gtest/gtest.h>

#include <string>

#include "resight/sensor/sensor_test_scenes.hpp"

namespace resight {
namespace {

using test::kNan;
using test::make_frame;
using test::small_camera;

TEST(CheckFrame, AcceptsAGoodFrameAndNamesWhatIsWrongOtherwise) {
  const Camera camera = small_camera();
  const RgbdFrame good = make_frame(camera, test::render_noisy_sphere(camera, 1));
  EXPECT_TRUE(check_frame(good).ok());
  EXPECT_LT(count_valid(good.depth_m), good.depth_m.size());
  EXPECT_GT(count_valid(good.depth_m), 15000U);

  const auto message_after = [&](auto&& damage) {
    RgbdFrame frame = good;
    damage(frame);
    const Result<void> result = check_frame(frame);
    return result.ok() ? std::string() : result.error().message;
  };
  const auto contains = [](const std::string& text, const char* part) { return text.find(part) != std::string::npos; };
  EXPECT_TRUE(contains(message_after([](RgbdFrame& f) { f.camera.fx = 0; }), "intrinsics"));
  EXPECT_TRUE(contains(message_after([](RgbdFrame& f) { f.depth_m = Image<float>(3, 3, 1.0F); }), "depth image"));
  EXPECT_TRUE(contains(message_after([](RgbdFrame& f) { f.color = {}; }), "colour image"));
  EXPECT_TRUE(contains(message_after([](RgbdFrame& f) { f.world_from_camera.rotation *= 1.1; }), "pose"));
  EXPECT_TRUE(contains(message_after([](RgbdFrame& f) { f.world_from_camera.translation.x() = kNan; }), "pose"));
  for (const float bad : {0.0F, -1.0F, 1.1e4F, std::numeric_limits<float>::infinity()})
    EXPECT_TRUE(contains(message_after([&](RgbdFrame& f) { f.depth_m[17] = bad; }), "depth contains"));
  EXPECT_TRUE(contains(message_after([](RgbdFrame& f) { f.camera.fx = 0; }), "view 'test'"));
}

TEST(DepthOrNone, KeepsWhatACameraCanMeasure) {
  EXPECT_EQ(depth_or_none(1.5), 1.5F);
  EXPECT_EQ(depth_or_none(kMaxReturn_m), kMaxReturn_m);
  for (const double none : {0.0, -1.0, 1e-60, 1.1e4, 1e10, 1e300, std::numeric_limits<double>::quiet_NaN()})
    EXPECT_TRUE(std::isnan(depth_or_none(none))) << none;
}

TEST(IsGrey, IsNotWithOneColouredPixel) {
  Image<Rgb8> color(4, 3, Rgb8{90, 91, 89});
  EXPECT_TRUE(is_grey(color));
  color(2, 1) = {90, 94, 90};
  EXPECT_FALSE(is_grey(color));
}

TEST(PrepareView, HoldsWhatTheStagesGiveOneByOne) {
  const Camera camera = small_camera();
  const RgbdFrame frame = make_frame(camera, test::render_noisy_sphere(camera, 1));
  const PreparedView view = prepare_view(frame, {.num_threads = 2});
  OrganizedCloud cloud = back_project(camera, frame.depth_m);
  compute_normals(cloud);
  EXPECT_TRUE(test::same_bytes(view.cloud.z, cloud.z));
  EXPECT_TRUE(test::same_bytes(view.cloud.nx, cloud.nx));
  EXPECT_TRUE(test::same_bytes(view.noise.axial_m, model_noise(cloud, camera).axial_m));
  EXPECT_TRUE(test::same_bytes(view.edge_distance_px, find_edge_distance(find_depth_edges(frame.depth_m), 5.0)));
  EXPECT_EQ(view.frame.name, "test");
}

TEST(PrepareView, DropsFarPointsButNotTheEvidenceOfFreeSpace) {
  const Camera camera = small_camera();
  const RgbdFrame frame = make_frame(camera, test::render_noisy_sphere(camera, 1));  // a sphere before a wall at 1.6 m
  const PreparedView whole = prepare_view(frame);
  const PreparedView view = prepare_view(frame, {.max_depth_m = 1.3});
  int num_kept = 0;
  int num_dropped = 0;
  for (std::size_t i = 0; i < frame.depth_m.size(); ++i) {
    const bool keeps = frame.depth_m[i] <= 1.3F;
    ASSERT_EQ(view.cloud.has_point(i), keeps);
    ASSERT_EQ(std::isnan(view.noise.axial_m[i]), !keeps);
    if (!keeps) {
      ASSERT_FALSE(view.cloud.has_normal(i));
    }
    (keeps ? num_kept : num_dropped) += 1;
    if (keeps && whole.cloud.has_normal(i)) {
      ASSERT_EQ(view.cloud.normal(i), whole.cloud.normal(i));
    }
  }
  EXPECT_GT(num_kept, 1000);
  EXPECT_GT(num_dropped, 1000);
  EXPECT_TRUE(test::same_bytes(view.frame.depth_m, frame.depth_m));
  EXPECT_TRUE(test::same_bytes(view.edge_distance_px, whole.edge_distance_px));
}

TEST(PrepareView, IsTheSameForAnyNumberOfThreads) {
  const Camera camera = small_camera();
  const RgbdFrame frame = make_frame(camera, test::render_noisy_sphere(camera, 9));
  const PreparedView serial = prepare_view(frame, {.num_threads = 1});
  const PreparedView parallel = prepare_view(frame, {.num_threads = 4});
  EXPECT_TRUE(test::same_bytes(serial.cloud.nz, parallel.cloud.nz));
  EXPECT_TRUE(test::same_bytes(serial.noise.axial_m, parallel.noise.axial_m));
  EXPECT_TRUE(test::same_bytes(serial.edge_distance_px, parallel.edge_distance_px));
}

TEST(PrepareView, TakesAFrameWithoutAnyMeasurement) {
  const Camera camera = small_camera();
  const PreparedView view = prepare_view(make_frame(camera, Image<float>(camera.width, camera.height, kNan)));
  EXPECT_TRUE(to_point_cloud(view.cloud, &view.frame.color, false).empty());
}

TEST(PrepareView, DropsWhatIsTooNearToBeMeasured) {
  const Camera camera = small_camera();
  RgbdFrame frame = make_frame(camera, Image<float>(camera.width, camera.height, 1.0F));
  for (int v = 0; v < 20; ++v)
    for (int u = 0; u < 30; ++u) frame.depth_m(u, v) = 0.11F;  // a gripper in the corner of the image
  const PreparedView view = prepare_view(frame);
  EXPECT_EQ(count_valid(view.cloud.z), camera.width * camera.height - 20 * 30);
  EXPECT_EQ(count_valid(view.frame.depth_m), camera.width * camera.height - 20 * 30);
  EXPECT_EQ(count_valid(prepare_view(frame, {.min_depth_m = std::nullopt}).cloud.z), camera.width * camera.height);
}

TEST(PrepareView, RefusesAnInvalidFrameAndBadOptions) {
  const Camera camera = small_camera();
  RgbdFrame frame = make_frame(camera, Image<float>(camera.width, camera.height, 1.0F));
  EXPECT_THROW((void)prepare_view(frame, {.min_depth_m = 0}), std::invalid_argument);
  EXPECT_THROW((void)prepare_view(frame, {.max_depth_m = -1}), std::invalid_argument);
  EXPECT_THROW((void)prepare_view(frame, {.num_threads = 0}), std::invalid_argument);
  EXPECT_THROW((void)prepare_view(frame, {.normals = {.window_radius_px = 0}}), std::invalid_argument);
  frame.depth_m[5] = -1;
  EXPECT_THROW((void)prepare_view(frame), std::invalid_argument);
}

}  // namespace
}  // namespace resight
