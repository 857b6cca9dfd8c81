// SPDX-License-Identifier: Apache-2.0
#include "resight/simulation/recording.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <numbers>

#include "resight/geometry/kd_tree.hpp"
#include "resight/io/mesh.hpp"
#include "resight/simulation/surface_sampling.hpp"

namespace resight {
namespace {

namespace fs = std::filesystem;

RecordingOptions few_views(RecordingKind kind = RecordingKind::kTurntable) {
  RecordingOptions options;
  options.kind = kind;
  options.step_deg = 120;
  options.num_threads = 2;
  return options;
}

// Largest distance of the masked points of a view from the surface.
double off_surface(const RecordedView& view, const KdTree& surface, int& checked) {
  double largest = 0;
  const Rigid3 object_from_camera = view.camera_from_object.inverse();
  for (int v = 0; v < view.mask.height(); ++v)
    for (int u = 0; u < view.mask.width(); ++u) {
      const float depth = view.frame.depth_m(u, v);
      if (view.mask(u, v) == 0 || std::isnan(depth) || (u + 7 * v) % 31 != 0) continue;
      const Eigen::Vector3d p = object_from_camera * view.frame.camera.unproject(u, v, depth);
      largest = std::max(largest, static_cast<double>(std::sqrt(surface.nearest(p.cast<float>()).distance_sq)));
      ++checked;
    }
  return largest;
}

std::size_t changed_pixels(const RecordedView& a, const RecordedView& b) {
  std::size_t changed = 0;
  for (std::size_t i = 0; i < a.mask.size(); ++i)
    changed += a.mask[i] == 0 && b.mask[i] == 0 && std::abs(a.frame.depth_m[i] - b.frame.depth_m[i]) > 0.001F;
  return changed;
}

TEST(Recording, TruthPutsThePixelsOfTheObjectOnItsSurface) {
  const TriangleMesh mesh = make_procedural_object("milk_carton")->mesh;
  const PointCloud surface = sample_visible_surface(mesh, 0.002);
  const KdTree tree(surface.points);
  for (const bool upside_down : {false, true}) {
    const RecordingKind kind = upside_down ? RecordingKind::kWalk : RecordingKind::kTurntable;
    RecordingOptions options = few_views(kind);
    options.upside_down = upside_down;
    options.sensor.noise_free = true;
    const std::vector<RecordedView> views = simulate_recording(mesh, options);
    ASSERT_EQ(views.size(), 3U);
    for (const RecordedView& view : views) {
      ASSERT_TRUE(check_frame(view.frame).ok());
      EXPECT_EQ(view.frame.world_from_camera.translation.norm(), 0);
      int checked = 0;
      EXPECT_LT(off_surface(view, tree, checked), 0.004);
      EXPECT_GT(checked, 300);
      // The camera is above the middle, independent of the side that is up.
      const Eigen::Vector3d eye = view.camera_from_object.inverse().translation;
      EXPECT_EQ(eye.z() > 0.1, !upside_down);
    }
  }
}

TEST(Recording, OnATurntableOnlyTheObjectAndItsDiscMove) {
  const TriangleMesh mesh = make_procedural_object("soup_pea")->mesh;
  RecordingOptions options = few_views();
  options.sensor.noise_free = true;
  const std::vector<RecordedView> turned = simulate_recording(mesh, options);
  // For a depth camera, a rotating disc is static except for the corners of its rim.
  EXPECT_LT(changed_pixels(turned[0], turned[1]), 40U);
  EXPECT_NE(turned[0].frame.color, turned[1].frame.color);
  options.num_threads = 1;
  EXPECT_EQ(simulate_recording(mesh, options)[1].frame.color, turned[1].frame.color);
  options.kind = RecordingKind::kWalk;
  const std::vector<RecordedView> walked = simulate_recording(mesh, options);
  EXPECT_GT(changed_pixels(walked[0], walked[1]), 100000U);
  for (const auto* views : {&turned, &walked}) {
    const double step =
        rotation_angle_rad((*views)[0].camera_from_object.rotation, (*views)[1].camera_from_object.rotation);
    EXPECT_NEAR(step, 2 * std::numbers::pi / 3, 0.1);
  }
}

TEST(Recording, WritesTwoSidesThatCanBeOpened) {
  const fs::path folder = fs::path(testing::TempDir()) / fmt::format("resight_recording_{}", ::getpid());
  fs::remove_all(folder);
  const ProceduralObject object = *make_procedural_object("soup_pea");
  int sides = 0;
  const auto written =
      write_recordings(object, folder, DatasetFormat::kTuw, few_views(), [&](const auto&) { ++sides; });
  ASSERT_TRUE(written.ok()) << written.error().message;
  EXPECT_EQ(sides, 2);
  RecordingOptions second = few_views();
  second.upside_down = true;
  const RecordedView expected = simulate_recording(object.mesh, second)[1];
  const auto sequence = open_sequence(folder / "side_2");
  ASSERT_TRUE(sequence.ok()) << sequence.error().message;
  ASSERT_EQ((*sequence)->num_views(), 3);
  EXPECT_EQ((*sequence)->read_view(1)->color, expected.frame.color);
  const auto truth = (*sequence)->read_ground_truth(1);
  ASSERT_EQ(truth->size(), 1U);
  EXPECT_EQ((*truth)[0].object, "soup_pea");
  EXPECT_LT(((*truth)[0].camera_from_object.matrix() - expected.camera_from_object.matrix()).norm(), 1e-6);
  EXPECT_EQ(read_mesh(folder / "truth" / "soup_pea.ply")->mesh.faces.size(), object.mesh.faces.size());
  EXPECT_FALSE(write_recordings(object, folder, DatasetFormat::kTuw, few_views()).ok());
  fs::remove_all(folder);
}

TEST(Recording, RefusesBadOptions) {
  RecordingOptions options;
  options.step_deg = 0;
  EXPECT_THROW(options.check(), std::invalid_argument);
  EXPECT_THROW(static_cast<void>(simulate_recording(TriangleMesh{})), std::invalid_argument);
}

}  // namespace
}  // namespace resight
