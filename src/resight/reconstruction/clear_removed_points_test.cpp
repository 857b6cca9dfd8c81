// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <stdexcept>

#include "resight/changes/analytic_scene_test_util.hpp"
#include "resight/changes/change_detector.hpp"
#include "resight/reconstruction/integration.hpp"
#include "resight/reconstruction/removal_history_test_util.hpp"

namespace resight {
namespace {

using namespace testing_scene;
const Box kBox{{0, 0, 0.1}, {0.12, 0.05, 0.1}, 0.4};

Scene scene_with_box() {
  Scene scene = table();
  scene.boxes = {kBox};
  return scene;
}

/// Bitwise equality, or both NaN.
bool same(const Image<float>& a, const Image<float>& b) {
  if (a.size() != b.size()) return false;
  for (std::size_t i = 0; i < a.size(); ++i)
    if (std::bit_cast<std::uint32_t>(a[i]) != std::bit_cast<std::uint32_t>(b[i]) &&
        !(std::isnan(a[i]) && std::isnan(b[i])))
      return false;
  return true;
}
bool same(const PreparedView& a, const PreparedView& b) {
  return same(a.frame.depth_m, b.frame.depth_m) && same(a.cloud.x, b.cloud.x) && same(a.cloud.y, b.cloud.y) &&
         same(a.cloud.z, b.cloud.z) && same(a.cloud.nx, b.cloud.nx) && same(a.cloud.ny, b.cloud.ny) &&
         same(a.cloud.nz, b.cloud.nz) && same(a.edge_distance_px, b.edge_distance_px) &&
         same(a.noise.lateral_m, b.noise.lateral_m) && same(a.noise.axial_m, b.noise.axial_m) &&
         a.frame.color == b.frame.color;
}

/// Some points on the visible surface of the box, away from the table.
PointCloud some_box_points(const PreparedView& view) {
  PointCloud removed;
  const PointCloud all = voxel_downsample(world_cloud(view), 0.01);
  for (const Eigen::Vector3f& p : all.points)
    if (is_at(kBox, p) && p.z() > 0.05F) removed.points.push_back(p);
  return removed;
}

TEST(ClearRemovedPoints, AgreesWithBruteForce) {
  const PreparedView before = see(scene_with_box());
  const PointCloud removed = some_box_points(before);
  ASSERT_GT(removed.size(), 100U);
  const double tolerance_m = 0.01;
  const PreparedView after = clear_removed_points(before, removed, tolerance_m);
  const Rigid3f world_from_camera(before.frame.world_from_camera);
  int num_cleared = 0;
  for (std::size_t i = 0; i < before.cloud.z.size(); ++i) {
    if (!before.cloud.has_point(i)) continue;
    double nearest = 1;
    for (const Eigen::Vector3f& p : removed.points)
      nearest = std::min<double>(nearest, (world_from_camera * before.cloud.point(i) - p).norm());
    if (std::abs(nearest - tolerance_m) < 1e-6) continue;  // Rounding of the frames.
    const bool cleared = nearest < tolerance_m;
    num_cleared += cleared ? 1 : 0;
    EXPECT_EQ(std::isnan(after.frame.depth_m[i]), cleared);
    EXPECT_EQ(std::isnan(after.cloud.x[i]), cleared);
    EXPECT_EQ(std::isnan(after.cloud.y[i]), cleared);
    EXPECT_EQ(std::isnan(after.cloud.z[i]), cleared);
    EXPECT_EQ(std::isnan(after.cloud.nx[i]), cleared || std::isnan(before.cloud.nx[i]));
    EXPECT_EQ(std::isnan(after.noise.axial_m[i]), cleared);
  }
  EXPECT_GT(num_cleared, 1000);
  EXPECT_EQ(after.frame.color, before.frame.color);
}

TEST(ClearRemovedPoints, EdgesAndNoiseAreThoseOfTheClearedDepth) {
  const PreparedView before = see(scene_with_box());
  const PreparedView after = clear_removed_points(before, some_box_points(before), 0.02);
  EXPECT_FALSE(same(after, before));
  EXPECT_FALSE(same(after.edge_distance_px, before.edge_distance_px));
  const DepthEdgeOptions edges;
  EXPECT_TRUE(same(after.edge_distance_px,
                   find_edge_distance(find_depth_edges(after.frame.depth_m, edges), edges.max_distance_px)));
  const NoiseImages noise = model_noise(after.cloud, after.frame.camera);
  EXPECT_TRUE(same(after.noise.lateral_m, noise.lateral_m));
  EXPECT_TRUE(same(after.noise.axial_m, noise.axial_m));
}

TEST(ClearRemovedPoints, UnchangedWhereNothingIsNear) {
  const PreparedView view = see(scene_with_box());
  EXPECT_TRUE(same(clear_removed_points(view, {}, 0.02), view));
  PointCloud far;
  far.points = {{0, 0, 3}, {5, 5, 5}};
  EXPECT_TRUE(same(clear_removed_points(view, far, 0.02), view));
}

TEST(ClearRemovedPoints, SerialIsParallel) {
  const PreparedView view = see(scene_with_box());
  const PointCloud removed = some_box_points(view);
  PrepareViewOptions parallel;
  parallel.num_threads = 3;
  EXPECT_TRUE(same(clear_removed_points(view, removed, 0.02), clear_removed_points(view, removed, 0.02, parallel)));
}

TEST(ClearRemovedPoints, RefusesNonsense) {
  const PreparedView view = see(table());
  EXPECT_THROW((void)clear_removed_points(view, {}, 0), std::invalid_argument);
  EXPECT_THROW((void)clear_removed_points(view, {}, -1), std::invalid_argument);
  PreparedView bare = view;
  bare.cloud.z = {};
  EXPECT_THROW((void)clear_removed_points(bare, {}, 0.02), std::invalid_argument);
}

/// Alg. 1 step by step, with the removals kept in a history.
class DynamicTable {
 public:
  ChangeResult add(const Scene& scene, const Rigid3& world_from_camera) {
    const PreparedView view = see(scene, world_from_camera);
    ChangeResult changes = detect_changes(reconstruction_.cloud_in_world, view);
    history_.add(static_cast<int>(views_.size()), changes.removed_in_world);
    views_.push_back(view);
    std::vector<PreparedView> cleared;
    std::vector<const PreparedView*> pointers;
    for (std::size_t v = 0; v < views_.size(); ++v)
      cleared.push_back(clear_removed_points(views_[v], history_.removed_after(static_cast<int>(v)), 0.02));
    for (const PreparedView& v : cleared) pointers.push_back(&v);
    reconstruction_ = integrate_views(pointers);
    return changes;
  }
  [[nodiscard]] int count_box_points() const {
    int count = 0;
    for (const Eigen::Vector3f& p : reconstruction_.cloud_in_world.points)
      count += is_at(kBox, p, 0.002) && p.z() > 0.03F ? 1 : 0;
    return count;
  }

 private:
  std::vector<PreparedView> views_;
  RemovalHistory history_;
  Reconstruction reconstruction_;
};

TEST(DynamicReconstruction, ARemovedObjectIsGoneAndOnePutBackSurvives) {
  DynamicTable world;
  const Rigid3 left = look_at({-0.3, -0.9, 0.8}, {0, 0, 0.05});
  const Rigid3 right = look_at({0.3, -0.9, 0.8}, {0, 0, 0.05});
  world.add(scene_with_box(), left);
  world.add(scene_with_box(), right);
  const int with_box = world.count_box_points();
  ASSERT_GT(with_box, 800);

  const ChangeResult gone = world.add(table(), usual_pose());
  EXPECT_GT(gone.removed_in_world.size(), 500U);
  EXPECT_LT(world.count_box_points(), with_box / 50);

  const ChangeResult back = world.add(scene_with_box(), left);
  EXPECT_TRUE(back.removed_in_world.empty());
  // The share of one view: the older removal does not affect it.
  EXPECT_GT(world.count_box_points(), with_box / 3);

  world.add(table(), right);
  EXPECT_LT(world.count_box_points(), with_box / 50);
}

}  // namespace
}  // namespace resight
