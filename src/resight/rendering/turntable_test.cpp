// SPDX-License-Identifier: Apache-2.0
#include "resight/rendering/turntable.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "resight/geometry/kd_tree.hpp"
#include "resight/simulation/procedural_objects.hpp"
#include "resight/simulation/surface_sampling.hpp"

namespace resight {
namespace {

TEST(Turntable, ViewsLieOnTheObjectAllAround) {
  const TriangleMesh mesh = make_procedural_object("milk_carton")->mesh;
  const PointCloud surface = sample_visible_surface(mesh, 0.002);
  ASSERT_GT(surface.size(), 5000U);
  const KdTree tree(surface.points);
  TurntableOptions options;
  options.step_deg = 60;
  options.num_threads = 2;
  const std::vector<TrainingView> views = render_turntable(mesh, options);
  ASSERT_EQ(views.size(), 12U);
  int from_above = 0;
  int checked = 0;
  for (const TrainingView& view : views) {
    ASSERT_TRUE(check_frame(view.frame).ok());
    from_above += view.frame.world_from_camera.translation.z() > 0.1;
    int top = 480;
    int bottom = -1;
    for (int v = 0; v < 480; ++v)
      for (int u = 0; u < 640; ++u) {
        const bool is_object = view.mask(u, v) != 0;
        ASSERT_EQ(is_object, !std::isnan(view.frame.depth_m(u, v)));
        if (!is_object) continue;
        top = std::min(top, v);
        bottom = std::max(bottom, v);
        if ((u + 7 * v) % 53 != 0) continue;
        const Eigen::Vector3d p =
            view.frame.world_from_camera * view.frame.camera.unproject(u, v, view.frame.depth_m(u, v));
        EXPECT_LT(std::sqrt(tree.nearest(p.cast<float>()).distance_sq), 0.005);
        ++checked;
      }
    EXPECT_GT(bottom - top, 150);
    EXPECT_LT(bottom - top, 280);
    EXPECT_GT(top, 0);
    EXPECT_LT(bottom, 479);
  }
  EXPECT_EQ(from_above, 6);
  EXPECT_GT(checked, 1000);
}

TEST(Turntable, SmallObjectsAreHalfAMetreAwayAndNoiseIsSeeded) {
  const TriangleMesh mesh = make_procedural_object("soup_pea")->mesh;
  TurntableOptions options;
  options.step_deg = 180;
  options.both_sides = false;
  options.sensor_noise = true;
  const std::vector<TrainingView> views = render_turntable(mesh, options);
  ASSERT_EQ(views.size(), 2U);
  EXPECT_NEAR((views[0].frame.world_from_camera.translation - Eigen::Vector3d(0, 0, 0.051)).norm(), 0.5, 1e-6);
  EXPECT_GT(count_valid(views[0].frame.depth_m), 2000U);
  options.num_threads = 2;
  EXPECT_EQ(render_turntable(mesh, options)[1].frame.color, views[1].frame.color);
  options.seed = 2;
  EXPECT_NE(render_turntable(mesh, options)[1].frame.color, views[1].frame.color);
}

TEST(Turntable, VerticesWithoutFacesDoNotMoveTheCamera) {
  TriangleMesh mesh = make_procedural_object("soup_pea")->mesh;
  TurntableOptions options;
  options.step_deg = 180;
  const TrainingView expected = render_turntable(mesh, options)[0];
  mesh.vertices.emplace_back(3.0F, 0.0F, 0.0F);
  if (!mesh.normals.empty()) mesh.normals.emplace_back(0.0F, 0.0F, 1.0F);
  if (!mesh.colors.empty()) mesh.colors.push_back({});
  const TrainingView view = render_turntable(mesh, options)[0];
  EXPECT_EQ(view.frame.world_from_camera.matrix(), expected.frame.world_from_camera.matrix());
}

TEST(Turntable, RefusesBadOptions) {
  TurntableOptions options;
  options.step_deg = 0;
  EXPECT_THROW(options.check(), std::invalid_argument);
  options = {};
  options.elevation_deg = 90;
  EXPECT_THROW(options.check(), std::invalid_argument);
  EXPECT_THROW(static_cast<void>(render_turntable(TriangleMesh{})), std::invalid_argument);
}

TEST(SampleVisibleSurface, LeavesOutWhatIsHidden) {
  // A box encloses a sphere, so that no point of the sphere is visible.
  TriangleMesh mesh = make_procedural_object("plain_box")->mesh;
  const std::size_t box_points = sample_visible_surface(mesh, 0.004).size();
  TriangleMesh inner = make_procedural_object("plain_can")->mesh;
  for (auto& v : inner.vertices) v.z() += 0.03F;
  mesh.append(inner);
  const PointCloud both = sample_visible_surface(mesh, 0.004);
  EXPECT_GT(box_points, 5000U);
  EXPECT_NEAR(static_cast<double>(both.size()), static_cast<double>(box_points),
              0.01 * static_cast<double>(box_points));
  for (std::size_t i = 0; i < both.size(); ++i)
    EXPECT_GT(both.normals[i].dot(both.points[i] - Eigen::Vector3f(0, 0, 0.095F)), 0);
}

}  // namespace
}  // namespace resight
