// SPDX-License-Identifier: Apache-2.0
#include "resight/rendering/depth_errors.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "resight/rendering/internal/smooth_noise.hpp"
#include "resight/rendering/sensor_model.hpp"
#include "resight/simulation/mesh_parts.hpp"

namespace resight {
namespace {

constexpr Camera kCamera{160, 120, 525, 525, 79.5, 59.5};

SensorOptions exact_with(const DepthErrors& errors) {
  SensorOptions o;
  o.lateral_noise = 0;
  o.axial_noise = 0;
  o.disparity_step_px = 0;
  o.projector_shadow = false;
  o.max_incidence_deg = 90;
  o.edge_dropout = 0;
  o.min_depth_m = 0.01;
  o.max_depth_m = 100;
  o.depth_errors = errors;
  return o;
}

TriangleMesh block(const Eigen::Vector3d& size, Rgb8 color) {
  TextureAtlas atlas(64, 1.0);
  const PixelRect region = atlas.solid(color);
  TriangleMesh mesh = make_box_part(size, {region, region, region, region, region, region}, 1);
  atlas.finish(mesh);
  return mesh;
}

// A wall that faces the camera at 2 m, and a small plate in front of its right half at 1 m.
struct Scene {
  explicit Scene(Rgb8 color = {128, 128, 128}, double wall_angle_rad = 0) {
    wall = scene.add_instance(
        scene.add_mesh(block({8, 8, 0.1}, color)),
        Rigid3::from_translation({0, 0, 2}) * Rigid3::from_axis_angle(Eigen::Vector3d::UnitY(), wall_angle_rad));
    scene.add_instance(scene.add_mesh(block({0.5, 0.1, 0.01}, color)), Rigid3::from_translation({0.25, 0, 1}));
    scene.commit();
  }
  [[nodiscard]] Image<float> sense(const DepthErrors& errors, double max_incidence_deg = 90,
                                   int num_threads = 1) const {
    SensorOptions options = exact_with(errors);
    options.max_incidence_deg = max_incidence_deg;
    return sense(options, num_threads);
  }
  [[nodiscard]] Image<float> sense(const SensorOptions& options, int num_threads = 1) const {
    return sense_depth(scene, kCamera, Rigid3::identity(), render_scene(scene, kCamera, Rigid3::identity()), options, 7,
                       num_threads);
  }
  RaycastScene scene;
  int wall = 0;
};

double hole_share(const Image<float>& depth_m, int u0, int u1, int v0, int v1) {
  double holes = 0;
  for (int v = v0; v < v1; ++v)
    for (int u = u0; u < u1; ++u) holes += std::isnan(depth_m(u, v)) ? 1 : 0;
  return holes / ((u1 - u0) * (v1 - v0));
}

TEST(SmoothNoise, HasUnitVarianceAndIsCorrelated) {
  const SmoothNoise noise(640, 480, 6, 3);
  double sum_sq = 0, near = 0, far = 0;
  int count = 0;
  for (int v = 0; v < 480; ++v)
    for (int u = 0; u + 30 < 640; ++u) {
      const double x = noise.at(u, v);
      sum_sq += x * x;
      near += x * noise.at(u + 1, v);
      far += x * noise.at(u + 30, v);
      ++count;
    }
  EXPECT_NEAR(sum_sq / count, 1, 0.05);
  EXPECT_GT(near / count, 0.9);
  EXPECT_NEAR(far / count, 0, 0.05);
  EXPECT_NEAR(normal_share_below(0), 0.5, 1e-12);
  EXPECT_NEAR(normal_share_below(1.6449), 0.95, 1e-4);
}

TEST(DepthErrors, BiasGrowsWithTheSquareOfDepth) {
  DepthErrors errors;
  errors.disparity_offset_px = -0.1;
  const Image<float> depth_m = Scene().sense(errors);
  const double bias_near = depth_m(120, 60) - 1;
  const double bias_far = depth_m(40, 60) - 2;
  EXPECT_NEAR(bias_near, 0.1 / (525 * 0.075), 1e-4);
  EXPECT_NEAR(bias_far / bias_near, 4, 0.05);
}

TEST(DepthErrors, NoiseIsCorrelatedOverNeighbours) {
  DepthErrors errors;
  errors.disparity_noise_px = 0.1;
  const Image<float> depth_m = Scene().sense(errors);
  double sum_sq = 0, steps_sq = 0;
  int count = 0;
  for (int v = 0; v < 30; ++v)
    for (int u = 0; u < 158; ++u) {
      sum_sq += std::pow(depth_m(u, v) - 2, 2);
      steps_sq += std::pow(depth_m(u + 1, v) - depth_m(u, v), 2);
      ++count;
    }
  EXPECT_NEAR(std::sqrt(sum_sq / count), 4 * 0.1 / (525 * 0.075), 1.5e-3);
  EXPECT_LT(steps_sq, 0.2 * sum_sq);
}

TEST(DepthErrors, DepthIsShiftedAgainstColour) {
  DepthErrors errors;
  errors.shift_u_px = 2;
  const Scene scene;
  const Image<float> shifted = scene.sense(errors);
  const Image<float> exact = scene.sense(DepthErrors{});
  for (int u = 60; u < 100; ++u) EXPECT_NEAR(shifted(u, 60), exact(u - 2, 60), 1e-5) << u;
}

TEST(DepthErrors, LensMovesTheCornersOnly) {
  const ResidualDistortion lens{0.05, 0};
  const Camera kinect = make_kinect_camera();
  EXPECT_NEAR((ideal_pixel(lens, kinect, 319, 240) - Eigen::Vector2d(319, 240)).norm(), 0, 1e-4);
  EXPECT_NEAR((ideal_pixel(lens, kinect, 0, 0)).norm(), 400 * 0.05 * 0.579, 0.2);  // r^2 = (400 / 525)^2
}

TEST(DepthErrors, HolesAreBesideEdges) {
  DepthErrors errors;
  errors.edge_band_px = 6;
  const Image<float> depth_m = Scene().sense(errors);
  EXPECT_GT(hole_share(depth_m, 90, 150, 32, 36), 0.3);  // the plate's edge is at row 33
  EXPECT_EQ(hole_share(depth_m, 0, 60, 0, 120), 0);
  EXPECT_EQ(hole_share(depth_m, 100, 150, 45, 75), 0);
}

TEST(DepthErrors, HolesAreAtGrazingAngles) {
  DepthErrors errors;
  errors.grazing_start_deg = 50;
  EXPECT_EQ(hole_share(Scene().sense(errors, 85), 0, 60, 0, 120), 0);
  const double share = hole_share(Scene({128, 128, 128}, 1.2).sense(errors, 85), 0, 60, 0, 120);
  EXPECT_GT(share, 0.2);
  EXPECT_LT(share, 0.95);
}

TEST(DepthErrors, NothingReturnsBeyondTheMaxIncidence) {
  const Scene steep({128, 128, 128}, 1.2);  // about 65 deg
  for (const double start_deg : {50.0, 65.0, 80.0, 89.0, 90.0}) {
    const DepthErrors errors{.grazing_start_deg = start_deg};
    EXPECT_EQ(hole_share(steep.sense(errors, 55), 0, 60, 0, 120), 1) << start_deg;
  }
}

TEST(DepthErrors, HolesAreOnDarkAndGlossyAndClearSurfaces) {
  DepthErrors errors;
  errors.dark_loss = 0.8;
  errors.highlight_loss = 1;
  EXPECT_EQ(hole_share(Scene().sense(errors), 0, 60, 0, 120), 0);
  EXPECT_GT(hole_share(Scene({8, 8, 8}).sense(errors), 0, 60, 0, 120), 0.4);
  Scene glossy;
  glossy.scene.set_material(glossy.wall, {.specular = 1, .shininess = 200});
  EXPECT_GT(hole_share(glossy.sense(errors), 60, 79, 0, 120), 0.5) << "where the wall faces the projector";
  EXPECT_LT(hole_share(glossy.sense(errors), 0, 10, 0, 20), 0.3);
  Scene clear;
  clear.scene.set_material(clear.wall, {.depth_return = 0.1});
  EXPECT_NEAR(hole_share(clear.sense(DepthErrors{}), 0, 60, 0, 120), 0.9, 0.06);
}

// It is a property of the surface: the other errors need not be switched on.
TEST(DepthErrors, ClearSurfacesAreLostWithoutOtherErrors) {
  SensorOptions options = exact_with({});
  options.depth_errors.reset();
  Scene scene;
  EXPECT_EQ(hole_share(scene.sense(options), 0, 60, 0, 120), 0);
  scene.scene.set_material(scene.wall, {.depth_return = 0.1});
  EXPECT_NEAR(hole_share(scene.sense(options), 0, 60, 0, 120), 0.9, 0.06);
  EXPECT_EQ(hole_share(scene.sense(options), 100, 150, 58, 62), 0) << "the plate is matte";
}

TEST(DepthErrors, HaveTheSameBytesForAnyNumberOfThreads) {
  DepthErrors errors{.disparity_noise_px = 0.1, .outline_noise_px = 1, .edge_band_px = 4, .grazing_start_deg = 40};
  const Scene scene;
  const Image<float> one = scene.sense(errors, 85, 1);
  const Image<float> four = scene.sense(errors, 85, 4);
  EXPECT_EQ(std::memcmp(one.data().data(), four.data().data(), one.data().size_bytes()), 0);
  EXPECT_GT(hole_share(one, 0, 160, 0, 120), 0);
}

}  // namespace
}  // namespace resight
