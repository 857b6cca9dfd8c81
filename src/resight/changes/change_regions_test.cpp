// SPDX-License-Identifier: Apache-2.0
#include "resight/changes/change_regions.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "resight/changes/analytic_scene_test_util.hpp"

namespace resight {
namespace {

using namespace testing_scene;

constexpr double kVoxel_m = 0.005;

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

// Far away, the steps of the disparity pull a slanted surface apart: 4.5 cm at 4 m.
TEST(ChangeRegions, NoiseOfFarDepthPartsNothing) {
  RgbdFrame frame = see(table(), usual_pose()).frame;
  frame.world_from_camera = Rigid3::identity();
  for (const float z_m : {1.0F, 4.0F}) {
    ChangeResult changes;
    for (int step = 0; step < 5; ++step)
      for (int i = 0; i < 20; ++i)
        changes.novel_in_world.points.emplace_back(0.005F * static_cast<float>(i), 0.0F,
                                                   z_m + 0.045F * static_cast<float>(step));
    EXPECT_EQ(find_change_regions(frame, changes, kVoxel_m).size(), z_m > 2 ? 1U : 5U);
  }
}

// At depth edges, measurements lie between the thing and what is behind it. Something small beside something large that
// does not touch it in the image stays.
TEST(ChangeRegions, AFragmentBelongsToTheThingThatItTouches) {
  RgbdFrame frame = see(table(), usual_pose()).frame;
  frame.world_from_camera = Rigid3::identity();
  ChangeResult changes;
  changes.novel_mask = Image<std::uint8_t>(frame.camera.width, frame.camera.height);
  const auto add = [&](int begin_u, int end_u, double z_m) {
    for (int v = 100; v < 120; ++v)
      for (int u = begin_u; u < end_u; ++u) {
        changes.novel_mask(u, v) = 1;
        const Eigen::Vector2d slope((u - frame.camera.cx) / frame.camera.fx, (v - frame.camera.cy) / frame.camera.fy);
        changes.novel_in_world.points.push_back((z_m * slope.homogeneous()).cast<float>());
      }
  };
  add(100, 140, 1.0);
  add(140, 142, 1.1);  // touches it
  add(150, 152, 1.0);
  const std::vector<ChangeRegion> regions = find_change_regions(frame, changes, kVoxel_m);
  ASSERT_EQ(regions.size(), 2U);
  EXPECT_EQ(regions[0].pixels.size(), 42U * 20U);
  EXPECT_EQ(regions[1].pixels.size(), 2U * 20U);
}

TEST(ChangeRegions, NoChangesAreNoRegions) {
  EXPECT_TRUE(find_change_regions(see(table(), usual_pose()).frame, {}, kVoxel_m).empty());
}

}  // namespace
}  // namespace resight
