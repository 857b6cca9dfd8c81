// SPDX-License-Identifier: Apache-2.0
#include "resight/changes/change_regions.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "resight/changes/analytic_scene_test_util.hpp"
#include "resight/core/random.hpp"

namespace resight {
namespace {

using namespace testing_scene;

constexpr double kVoxel_m = 0.005;

PointCloud random_box(const Rigid3& world_from_box, const Eigen::Vector3d& size_m, int num_points, std::uint64_t seed) {
  Rng rng(seed);
  PointCloud cloud;
  for (int i = 0; i < num_points; ++i) {
    const Eigen::Vector3d p(rng.uniform(-0.5, 0.5), rng.uniform(-0.5, 0.5), rng.uniform(-0.5, 0.5));
    cloud.points.push_back((world_from_box * p.cwiseProduct(size_m).eval()).cast<float>());
  }
  return cloud;
}

Scene table_with(const std::vector<Box>& boxes) {
  Scene scene = table();
  scene.boxes = boxes;
  return scene;
}

ChangeResult changes_between(const PreparedView& before, const PreparedView& after) {
  const PreparedView* earlier[] = {&before};
  return detect_changes(world_cloud(before), after, {.test = DepthTestOptions{}}, earlier);
}

double count_set(const Image<std::uint8_t>& mask) {
  return static_cast<double>(std::ranges::count_if(mask.data(), [](auto m) { return m != 0; }));
}

TEST(FitBox, FindsPoseAndSizeOfABox) {
  const Rigid3 world_from_box{Rigid3::from_axis_angle({1, -2, 0.5}, 0.8).rotation, {0.3, -1, 2}};
  const OrientedBox box = fit_box(random_box(world_from_box, {0.1, 0.3, 0.2}, 20000, 1));
  EXPECT_NEAR(box.size_m.x(), 0.3, 0.01);
  EXPECT_NEAR(box.size_m.y(), 0.2, 0.01);
  EXPECT_NEAR(box.size_m.z(), 0.1, 0.01);
  EXPECT_LT((box.world_from_box.translation - world_from_box.translation).norm(), 0.005);
  EXPECT_GT(std::abs(box.world_from_box.rotation.col(0).dot(world_from_box.rotation.col(1))), 0.999);
  EXPECT_GT(std::abs(box.world_from_box.rotation.col(2).dot(world_from_box.rotation.col(0))), 0.999);
  EXPECT_TRUE(box.world_from_box.is_rigid());
}

TEST(FitBox, HoldsAllPoints) {
  const PointCloud cloud = random_box({}, {0.1, 0.3, 0.2}, 50, 2);
  const OrientedBox box = fit_box(cloud);
  const Rigid3 box_from_world = box.world_from_box.inverse();
  for (const Eigen::Vector3f& p : cloud.points) {
    const Eigen::Vector3d in_box = (box_from_world * p.cast<double>().eval()).cwiseAbs();
    EXPECT_TRUE((in_box.array() <= box.size_m.array() / 2 + 1e-6).all());
  }
}

TEST(FitBox, APointIsABoxWithoutSize) {
  const OrientedBox box = fit_box({{{1, 2, 3}}, {}, {}});
  EXPECT_EQ(box.size_m, Eigen::Vector3d::Zero());
  EXPECT_EQ(box.world_from_box.translation, Eigen::Vector3d(1, 2, 3));
}

// A carton that came, and another that left, are one region each, but for a few pixels at depth edges. Boxes lie where
// the visible surface is.
TEST(ChangeRegions, OneThingIsOneRegion) {
  const Box came{{-0.15, 0, 0.1}, {0.12, 0.05, 0.1}, 0.4};
  const Box left{{0.2, 0, 0.1}, {0.05, 0.05, 0.1}, 0.0};
  const PreparedView after = see(table_with({came}), usual_pose());
  const ChangeResult changes = changes_between(see(table_with({left}), usual_pose()), after);
  const std::vector<ChangeRegion> regions = find_change_regions(after.frame, changes, kVoxel_m);
  const auto first_removed =
      std::ranges::find_if(regions, [](const ChangeRegion& r) { return r.kind == RegionKind::kRemoved; });
  ASSERT_FALSE(regions.empty());
  ASSERT_NE(first_removed, regions.end());
  EXPECT_EQ(regions[0].kind, RegionKind::kNovel);
  EXPECT_GT(static_cast<double>(regions[0].pixels.size()), 0.95 * count_set(changes.novel_mask));
  EXPECT_GT(static_cast<double>(first_removed->pixels.size()), 0.95 * count_set(changes.removed_mask));
  EXPECT_NEAR(regions[0].box.world_from_box.translation.x(), came.center.x(), 0.06);
  EXPECT_NEAR(first_removed->box.world_from_box.translation.x(), left.center.x(), 0.06);
}

TEST(ChangeRegions, EachPixelOfTheMasksBelongsToOneRegion) {
  const Box near{{-0.2, -0.1, 0.1}, {0.05, 0.05, 0.1}, 0.4};
  const Box far{{0.2, 0.1, 0.1}, {0.05, 0.05, 0.1}, 0.0};
  const PreparedView after = see(table_with({near, far}), usual_pose());
  const ChangeResult changes = changes_between(see(table(), usual_pose()), after);
  Image<std::uint8_t> seen(after.frame.camera.width, after.frame.camera.height);
  for (const ChangeRegion& region : find_change_regions(after.frame, changes, kVoxel_m)) {
    EXPECT_TRUE(std::ranges::is_sorted(region.pixels));
    for (const int pixel : region.pixels) ++seen[static_cast<std::size_t>(pixel)];
  }
  EXPECT_GT(count_set(changes.novel_mask), 200);
  EXPECT_TRUE(std::ranges::equal(seen.data(), changes.novel_mask.data()));
}

// Pieces of a surface 15 mm apart belong together, pieces 25 mm apart do not. Larger regions come first.
TEST(ChangeRegions, GapsOfFourVoxelsAreBridged) {
  ChangeResult changes;
  for (const float x_m : {0.0F, 0.025F, 0.040F}) changes.novel_in_world.points.emplace_back(x_m, 0.0F, 1.0F);
  const RgbdFrame frame = see(table(), usual_pose()).frame;
  const std::vector<ChangeRegion> regions = find_change_regions(frame, changes, kVoxel_m);
  ASSERT_EQ(regions.size(), 2U);
  EXPECT_EQ(regions[0].surface_in_world.size(), 2U);
  EXPECT_EQ(regions[1].surface_in_world.size(), 1U);
}

TEST(ChangeRegions, NoChangesAreNoRegions) {
  EXPECT_TRUE(find_change_regions(see(table(), usual_pose()).frame, {}, kVoxel_m).empty());
}

}  // namespace
}  // namespace resight
