// SPDX-License-Identifier: Apache-2.0
#include "resight/rendering/sensor_model.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numbers>

#include "resight/sensor/noise_model.hpp"
#include "resight/sensor/rgbd_frame.hpp"
#include "resight/simulation/mesh_parts.hpp"

namespace resight {
namespace {

constexpr Camera kSensorCamera{160, 120, 525, 525, 79.5, 59.5};

SensorOptions all_off() {
  SensorOptions o;
  o.lateral_noise = 0;
  o.axial_noise = 0;
  o.disparity_step_px = 0;
  o.projector_shadow = false;
  o.max_incidence_deg = 90;
  o.edge_dropout = 0;
  o.min_depth_m = 0.01;
  o.max_depth_m = 100;
  o.color_noise = 0;
  o.gain_sigma = 0;
  o.white_balance_sigma = 0;
  return o;
}

TriangleMesh sensed_block(const Eigen::Vector3d& size) {
  TextureAtlas atlas(64, 1.0);
  const PixelRect grey = atlas.solid({128, 128, 128});
  TriangleMesh mesh = make_box_part(size, {grey, grey, grey, grey, grey, grey}, 1);
  atlas.finish(mesh);
  return mesh;
}

// A wall with its centre `z` in front of the camera, rotated by `angle_rad` about the y axis of the image.
struct Wall {
  explicit Wall(double z, double angle_rad = 0) {
    Rigid3 pose = Rigid3::from_translation({0, 0, z}) * Rigid3::from_axis_angle(Eigen::Vector3d::UnitY(), angle_rad);
    scene.add_instance(scene.add_mesh(sensed_block({4, 4, 0.1})), pose);  // its bottom (z = 0) faces the camera
    scene.commit();
    view = render_scene(scene, kSensorCamera, Rigid3::identity());
  }
  Image<float> sense(const SensorOptions& options, std::uint64_t seed = 7, int num_threads = 1) const {
    return sense_depth(scene, kSensorCamera, Rigid3::identity(), view, options, seed, num_threads);
  }
  RaycastScene scene;
  RenderedView view;
};

bool same_bytes(const Image<float>& a, const Image<float>& b) {
  return a.size() == b.size() && std::memcmp(a.data().data(), b.data().data(), a.size() * sizeof(float)) == 0;
}

TEST(SenseDepth, NoiseFreeIsExact) {
  const Wall wall(1.3, 0.4);
  SensorOptions options;
  options.noise_free = true;
  EXPECT_TRUE(same_bytes(wall.sense(options), wall.view.depth_m));
  EXPECT_TRUE(same_bytes(wall.sense(all_off()), wall.view.depth_m));
  EXPECT_EQ(std::ranges::count_if(wall.view.depth_m.data(), [](float z) { return std::isnan(z); }), 0);
}

TEST(SenseDepth, AxialNoiseHasNguyensSigma) {
  for (const double z : {0.8, 1.5, 3.0}) {
    const Wall wall(z);
    SensorOptions options = all_off();
    options.axial_noise = 1;
    const Image<float> depth = wall.sense(options);
    double sum = 0;
    double sum_sq = 0;
    double expected_sq = 0;
    for (int v = 0; v < kSensorCamera.height; ++v)
      for (int u = 0; u < kSensorCamera.width; ++u) {
        const double error = depth(u, v) - wall.view.depth_m(u, v);
        const Eigen::Vector3d ray = kSensorCamera.unproject(u, v, 1.0);
        const double sigma = nguyen_noise(z, std::acos(1.0 / ray.norm()), kSensorCamera.fx).axial_m;
        sum += error;
        sum_sq += error * error;
        expected_sq += sigma * sigma;
      }
    const double n = static_cast<double>(depth.size());
    const double sigma = std::sqrt(expected_sq / n);
    EXPECT_NEAR(sum / n, 0, 5 * sigma / std::sqrt(n)) << z;
    EXPECT_NEAR(std::sqrt(sum_sq / n) / sigma, 1, 5 / std::sqrt(2 * n)) << z;
  }
}

TEST(SenseDepth, LateralNoiseMovesSlantedSurfaces) {
  // On a plane z = z0 + x tan(angle), a lateral shift of s px changes the depth by about s z tan(angle) / f.
  constexpr double kAngle = 0.6;
  const Wall wall(1.2, -kAngle);
  SensorOptions options = all_off();
  options.lateral_noise = 1;
  const Image<float> depth = wall.sense(options);
  double ratio_sq = 0;
  int count = 0;
  for (int v = 20; v < 100; ++v)
    for (int u = 60; u < 100; ++u) {
      const double z = wall.view.depth_m(u, v);
      const double slope = 0.5 * (wall.view.depth_m(u + 1, v) - wall.view.depth_m(u - 1, v));  // m per px
      const Eigen::Vector3d direction = kSensorCamera.unproject(u, v, 1.0).normalized();
      const double angle = std::acos(std::abs(wall.view.normals_in_camera(u, v).cast<double>().dot(direction)));
      const double sigma_px = nguyen_noise(z, angle, kSensorCamera.fx).lateral_m * kSensorCamera.fx / z;
      ratio_sq += std::pow((depth(u, v) - z) / (slope * sigma_px), 2);
      ++count;
    }
  ASSERT_EQ(count, 3200);
  EXPECT_NEAR(std::sqrt(ratio_sq / count), 1, 6 / std::sqrt(2.0 * count));
}

TEST(SenseDepth, DisparityComesInSteps) {
  const Wall wall(1.0, 0.5);
  SensorOptions options = all_off();
  options.disparity_step_px = 0.125;
  const Image<float> depth = wall.sense(options);
  int distinct_from_exact = 0;
  for (std::size_t i = 0; i < depth.size(); ++i) {
    const double steps = kSensorCamera.fx * options.baseline_m / depth[i] / options.disparity_step_px;
    EXPECT_NEAR(steps, std::round(steps), 1e-4);
    const double exact = kSensorCamera.fx * options.baseline_m / wall.view.depth_m[i] / options.disparity_step_px;
    EXPECT_LE(std::abs(steps - exact), 0.5 + 1e-3);
    distinct_from_exact += std::abs(steps - exact) > 0.1;
  }
  EXPECT_GT(distinct_from_exact, 5000);
  // Kinect at 1 m: steps of z^2 / (8 f b), about 3 mm.
  const double focal_baseline = 525 * 0.075;  // 315 eighths of a pixel at exactly 1 m
  EXPECT_NEAR(quantize_depth(1.0010, focal_baseline, 0.125), 1.0, 1e-12);
  EXPECT_NEAR(quantize_depth(0.9975, focal_baseline, 0.125), 315.0 / 316.0, 1e-12);
}

TEST(SenseDepth, ProjectorShadowLiesBesideTheBoxOnTheFarSide) {
  // A box of 0.2 m width, with its front at 1.0 m, before a wall at 2.0 m. The projector is 7.5 cm to the right (+x),
  // so the strip of the wall hidden from it lies left of the box: the edge at x = -0.1 projects from x = 0.075 to x =
  // -0.275 at 2 m.
  RaycastScene scene;
  scene.add_instance(scene.add_mesh(sensed_block({6, 6, 0.1})), Rigid3::from_translation({0, 0, 2.0}));
  scene.add_instance(scene.add_mesh(sensed_block({0.2, 0.2, 0.001})), Rigid3::from_translation({0, 0, 1.0}));
  scene.commit();
  const Camera camera{320, 240, 260, 260, 159.5, 119.5};
  const RenderedView view = render_scene(scene, camera, Rigid3::identity());
  SensorOptions options = all_off();
  options.projector_shadow = true;
  const Image<float> depth = sense_depth(scene, camera, Rigid3::identity(), view, options, 1);
  const auto column = [&](double x, double z) { return static_cast<int>(std::lround(camera.fx * x / z + camera.cx)); };
  const int v = 120;
  int shadowed = 0;
  for (int u = column(-0.27, 2.0); u < column(-0.1, 1.0) - 1; ++u) {  // x/z from -0.135 to -0.1
    EXPECT_TRUE(std::isnan(depth(u, v))) << u;
    ++shadowed;
  }
  EXPECT_GT(shadowed, 5);
  EXPECT_FALSE(std::isnan(depth(column(-0.285, 2.0), v)));
  // No shadow on the right.
  for (int u = column(0.1, 1.0) + 2; u < 300; ++u) EXPECT_FALSE(std::isnan(depth(u, v))) << u;
  for (int u = column(-0.1, 1.0) + 1; u < column(0.1, 1.0); ++u) EXPECT_NEAR(depth(u, v), 1.0, 1e-5);  // the box itself
}

TEST(SenseDepth, DropsGrazingFarNearAndEdges) {
  SensorOptions options = all_off();
  options.max_incidence_deg = 75;
  const Wall slanted(1.0, 80 * std::numbers::pi / 180);
  const Image<float> grazing = slanted.sense(options);
  EXPECT_GT(count_valid(slanted.view.depth_m), 1000U);
  for (int v = 0; v < kSensorCamera.height; ++v) EXPECT_TRUE(std::isnan(grazing(80, v)));

  options = all_off();
  options.min_depth_m = 0.5;
  options.max_depth_m = 4.0;
  EXPECT_EQ(count_valid(Wall(0.45).sense(options)), 0U);
  EXPECT_EQ(count_valid(Wall(4.1).sense(options)), 0U);
  EXPECT_EQ(count_valid(Wall(3.9).sense(options)), static_cast<std::size_t>(160 * 120));

  RaycastScene scene;
  scene.add_instance(scene.add_mesh(sensed_block({4, 4, 0.1})), Rigid3::from_translation({0, 0, 2}));
  scene.add_instance(scene.add_mesh(sensed_block({0.2, 0.2, 0.1})), Rigid3::from_translation({0, 0, 1}));
  scene.commit();
  const RenderedView view = render_scene(scene, kSensorCamera, Rigid3::identity());
  options = all_off();
  options.edge_dropout = 0.5;
  const Image<float> depth = sense_depth(scene, kSensorCamera, Rigid3::identity(), view, options, 3);
  const std::size_t lost = depth.size() - count_valid(depth);
  const double edge_pixels = 2 * 4 * 0.2 * 525;  // both sides of the outline, as far as it lies within the image
  EXPECT_GT(lost, 0.25 * edge_pixels);
  EXPECT_LT(lost, 0.75 * edge_pixels);
  EXPECT_FALSE(std::isnan(depth(80, 60)));
}

TEST(SenseDepth, SeedDecidesAndThreadsDoNot) {
  const Wall wall(1.4, 0.3);
  const SensorOptions options;
  const Image<float> serial = wall.sense(options, 5, 1);
  EXPECT_TRUE(same_bytes(serial, wall.sense(options, 5, 3)));
  EXPECT_FALSE(same_bytes(serial, wall.sense(options, 6, 1)));
}

TEST(SenseColor, NoiseAndGainAreAsAsked) {
  const Image<Rgb8> grey(200, 200, Rgb8{120, 120, 120});
  SensorOptions options = all_off();
  EXPECT_EQ(sense_color(grey, options, 1), grey);
  options.color_noise = 3;
  const Image<Rgb8> noisy = sense_color(grey, options, 1);
  double sum = 0;
  double sum_sq = 0;
  for (const Rgb8 c : noisy.data()) {
    sum += c.g - 120.0;
    sum_sq += (c.g - 120.0) * (c.g - 120.0);
  }
  const double n = static_cast<double>(noisy.size());
  EXPECT_NEAR(sum / n, 0, 5 * 3 / std::sqrt(n));
  EXPECT_NEAR(std::sqrt(sum_sq / n), std::sqrt(9 + 1.0 / 12), 0.1);  // rounding adds 1/12
  EXPECT_EQ(noisy, sense_color(grey, options, 1, 3));
  options.color_noise = 0;
  options.gain_sigma = 0.1;
  double gain_sq = 0;
  for (std::uint64_t seed = 0; seed < 200; ++seed)
    gain_sq +=
        std::pow(std::log(sense_color(Image<Rgb8>(1, 1, Rgb8{120, 120, 120}), options, seed)(0, 0).r / 120.0), 2);
  EXPECT_NEAR(std::sqrt(gain_sq / 200), 0.1, 0.025);
}

TEST(SensorOptions, RefusesNonsense) {
  const auto expect_refused = [](auto change) {
    SensorOptions options;
    change(options);
    EXPECT_THROW(options.check(), std::invalid_argument);
  };
  EXPECT_NO_THROW(SensorOptions{}.check());
  expect_refused([](SensorOptions& o) { o.axial_noise = -1; });
  expect_refused([](SensorOptions& o) { o.lateral_noise = std::nan(""); });
  expect_refused([](SensorOptions& o) { o.baseline_m = 0; });
  expect_refused([](SensorOptions& o) { o.max_incidence_deg = 91; });
  expect_refused([](SensorOptions& o) { o.edge_dropout = 1.5; });
  expect_refused([](SensorOptions& o) { o.max_depth_m = o.min_depth_m; });
  expect_refused([](SensorOptions& o) { o.gain_sigma = 1000; });
  expect_refused([](SensorOptions& o) { o.white_balance_sigma = 2.1; });
}

}  // namespace
}  // namespace resight
