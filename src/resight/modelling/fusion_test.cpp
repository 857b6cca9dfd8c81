// SPDX-License-Identifier: Apache-2.0
#include "resight/modelling/fusion.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "resight/modelling/mesh_quality.hpp"
#include "resight/modelling/surface_error_test_util.hpp"
#include "resight/rendering/turntable.hpp"
#include "resight/rendering/view_renderer.hpp"
#include "resight/simulation/procedural_objects.hpp"

namespace resight {
namespace {

// An exact ball of radius 6 cm, seen from six sides.
std::vector<TrainingView> look_at_ball(double radius_m) {
  std::vector<TrainingView> views;
  for (int axis = 0; axis < 3; ++axis)
    for (const double side : {-1.0, 1.0}) {
      TrainingView view;
      view.frame.camera = {240, 240, 400, 400, 119.5, 119.5};
      Eigen::Vector3d eye = Eigen::Vector3d::Zero();
      eye[axis] = 0.5 * side;
      view.frame.world_from_camera = look_at(eye, Eigen::Vector3d::Zero(), Eigen::Vector3d::Unit((axis + 1) % 3));
      view.frame.depth_m = Image<float>(240, 240, 2.0F);
      view.frame.color = Image<Rgb8>(240, 240, {static_cast<std::uint8_t>(side > 0 ? 200 : 60), 100, 50});
      view.mask = Image<std::uint8_t>(240, 240, 0);
      for (int v = 0; v < 240; ++v)
        for (int u = 0; u < 240; ++u) {
          const Eigen::Vector3d ray = view.frame.camera.unproject(u, v, 1);
          const double b = ray.z() * 0.5;
          const double root = b * b - ray.squaredNorm() * (0.25 - radius_m * radius_m);
          if (root < 0) continue;
          view.frame.depth_m(u, v) = static_cast<float>((b - std::sqrt(root)) / ray.squaredNorm());
          view.mask(u, v) = 255;
        }
      views.push_back(std::move(view));
    }
  return views;
}

TEST(FuseViews, ABallIsClosedRoundAndFacesOutwards) {
  FuseViewsOptions options;
  options.voxel_m = 0.002;
  options.min_weight = 0.1;
  options.num_threads = 2;
  const TriangleMesh mesh = fuse_views(look_at_ball(0.06), options);
  ASSERT_GT(mesh.faces.size(), 10000U);
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    EXPECT_NEAR(mesh.vertices[i].norm(), 0.06, 0.001);
    EXPECT_GT(mesh.normals[i].dot(mesh.vertices[i].normalized()), 0.8);
  }
  EXPECT_NEAR(surface_area(mesh), 4 * 3.14159 * 0.06 * 0.06, 0.001);
  EXPECT_EQ(measure_holes(mesh).boundary_length_m, 0);
  // Colours come from the view that faces the place.
  const auto right = std::ranges::max_element(mesh.vertices, {}, [](const auto& p) { return p.x(); });
  const auto left = std::ranges::min_element(mesh.vertices, {}, [](const auto& p) { return p.x(); });
  EXPECT_GT(mesh.colors[right - mesh.vertices.begin()].r, 180);
  EXPECT_LT(mesh.colors[left - mesh.vertices.begin()].r, 80);
}

// The same views as the lamp turns away and with specular highlights: three of a kind at each place.
TEST(FuseViews, ColoursAreThoseOfTheBestLight) {
  std::vector<TrainingView> views;
  for (const int grey : {40, 60, 80, 100, 150, 160, 255})
    for (TrainingView& view : look_at_ball(0.06)) {
      const auto level = static_cast<std::uint8_t>(grey);
      std::ranges::fill(view.frame.color.data(), Rgb8{level, level, level});
      views.push_back(std::move(view));
    }
  FuseViewsOptions options;
  options.voxel_m = 0.003;
  options.truncation_m = 0.009;
  options.num_threads = 2;
  for (const Rgb8 c : fuse_views(views, options).colors) EXPECT_NEAR(c.g, 160, 25);
  options.color_from = 0;
  options.color_to = 1;
  for (const Rgb8 c : fuse_views(views, options).colors) EXPECT_NEAR(c.g, 121, 3);
}

TEST(FuseViews, WhatAnotherViewSeesThroughIsCutAway) {
  std::vector<TrainingView> views = look_at_ball(0.06);
  // A blob beside the ball, in one view only.
  for (int v = 110; v < 130; ++v)
    for (int u = 185; u < 205; ++u) {
      views[1].frame.depth_m(u, v) = 0.5F;
      views[1].mask(u, v) = 255;
    }
  const auto farthest = [](const TriangleMesh& mesh) {
    return std::ranges::max(mesh.vertices, {}, [](const auto& p) { return p.norm(); }).norm();
  };
  FuseViewsOptions options;
  options.voxel_m = 0.002;
  options.min_component_share = 0;
  EXPECT_LT(farthest(fuse_views(views, options)), 0.062);
  options.max_free_share = 1e9;
  EXPECT_GT(farthest(fuse_views(views, options)), 0.08);
}

TEST(FuseViews, SameMeshForAnyNumberOfThreads) {
  const std::vector<TrainingView> views = look_at_ball(0.04);
  FuseViewsOptions options;
  const TriangleMesh one = fuse_views(views, options);
  options.num_threads = 2;
  const TriangleMesh two = fuse_views(views, options);
  EXPECT_EQ(one.vertices, two.vertices);
  EXPECT_EQ(one.faces, two.faces);
  EXPECT_EQ(one.colors, two.colors);
}

TEST(FuseViews, NoPointsNoMesh) {
  std::vector<TrainingView> views = look_at_ball(0.06);
  for (TrainingView& view : views) std::ranges::fill(view.mask.data(), std::uint8_t{0});
  EXPECT_TRUE(fuse_views(views).empty());
  EXPECT_TRUE(fuse_views({}).empty());
  FuseViewsOptions options;
  options.truncation_m = 0.001;
  EXPECT_THROW(options.check(), std::invalid_argument);
}

TEST(FuseViews, AnObjectWithNoiseIsRightToAMillimetre) {
  for (const char* name : {"milk_carton", "mug"}) {
    const TriangleMesh truth = make_procedural_object(name)->mesh;
    TurntableOptions turntable;
    turntable.step_deg = 30;
    turntable.sensor_noise = true;
    turntable.num_threads = 2;
    FuseViewsOptions options;
    options.num_threads = 2;
    const TriangleMesh mesh = fuse_views(render_turntable(truth, turntable), options);
    const test::SurfaceError error = test::measure_surface_error(mesh, truth);
    EXPECT_LT(error.median_m, 0.001) << name;
    EXPECT_LT(error.p95_m, 0.003) << name;
    // No view looks into the mug from above.
    EXPECT_GT(error.completeness, name == std::string("mug") ? 0.7 : 0.9) << name;
    EXPECT_LT(measure_holes(mesh).open_share, 0.15) << name;
  }
}

}  // namespace
}  // namespace resight
