// SPDX-License-Identifier: Apache-2.0
#include "resight/modelling/object_region.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "resight/modelling/recorded_object_test_util.hpp"

namespace resight {
namespace {

// Intersection over union of both masks; the true mask counts where there is depth.
double mask_overlap(const RecordedView& view, const Image<std::uint8_t>& found) {
  std::size_t both = 0;
  std::size_t either = 0;
  for (std::size_t i = 0; i < found.size(); ++i) {
    const bool truth = view.mask[i] != 0 && !std::isnan(view.frame.depth_m[i]);
    both += truth && found[i] != 0;
    either += truth || found[i] != 0;
  }
  return static_cast<double>(both) / static_cast<double>(either);
}

// The origin of the object frame is the bottom of the object, so its height above the found support must be zero.
void expect_found(const RecordedView& view, const std::optional<ObjectRegion>& region, const PreparedView& prepared,
                  double min_overlap) {
  ASSERT_TRUE(region.has_value()) << view.frame.name;
  const Eigen::Vector3d foot = view.camera_from_object.translation;
  EXPECT_NEAR(region->plane.height_m(foot), 0, 0.003);
  EXPECT_GT(region->plane.normal.dot(view.camera_from_object.rotation.col(2)), std::cos(0.03));
  EXPECT_LT(region->axis_distance_m(foot), 0.03);
  const Image<std::uint8_t> mask = segment_object(prepared.cloud, *region);
  EXPECT_GT(mask_overlap(view, mask), min_overlap) << view.frame.name;
}

TEST(ObjectRegion, FindsTheTurntableBelowAnObjectAndTheObjectOnIt) {
  for (const char* name : {"milk_carton", "novel", "toy_car"})
    for (const RecordedView& view : test::record(name, 120)) {
      const PreparedView prepared = prepare_view(view.frame);
      expect_found(view, find_object_region(prepared), prepared, name == std::string("novel") ? 0.75 : 0.85);
    }
}

TEST(ObjectRegion, FollowsAWalkAroundAnObject) {
  std::optional<ObjectRegion> region;
  for (const RecordedView& view : test::record("mug", 60, false, RecordingKind::kWalk)) {
    const PreparedView prepared = prepare_view(view.frame);
    region = find_object_region(prepared, {}, region ? &*region : nullptr);
    expect_found(view, region, prepared, 0.8);
  }
}

/// A slab of 2.5 cm on a plane, seen from 0.9 m by a camera that looks down by `pitch_rad`.
PreparedView look_down_on_slab(double pitch_rad) {
  RgbdFrame frame;
  frame.camera = {320, 240, 280, 280, 159.5, 119.5};
  frame.color = Image<Rgb8>(320, 240);
  frame.depth_m = Image<float>(320, 240);
  const Eigen::Vector3d up(0, -std::cos(pitch_rad), -std::sin(pitch_rad));
  for (int v = 0; v < 240; ++v)
    for (int u = 0; u < 320; ++u) {
      const double slab_m = std::abs(u - 160) < 12 && std::abs(v - 120) < 12 ? 0.025 : 0;
      const double depth_m = (slab_m - 0.9 * std::sin(pitch_rad)) / up.dot(frame.camera.unproject(u, v, 1));
      frame.depth_m(u, v) = depth_m > 0 ? static_cast<float>(depth_m) : std::numeric_limits<float>::quiet_NaN();
    }
  return prepare_view(std::move(frame));
}

TEST(ObjectRegion, APlaneBelowASteepCameraIsTakenForAWall) {
  ObjectRegionOptions options;
  EXPECT_TRUE(find_object_region(look_down_on_slab(0.5), options).has_value());
  EXPECT_TRUE(find_object_region(look_down_on_slab(1.3), options).has_value());
  options.max_pitch_rad = 0.7;
  EXPECT_TRUE(find_object_region(look_down_on_slab(0.5), options).has_value());
  EXPECT_FALSE(find_object_region(look_down_on_slab(1.3), options).has_value());
}

TEST(ObjectRegion, NothingStandsOnAnEmptyTable) {
  RecordedView view = test::record("novel", 120)[0];
  // Only the table near the camera is left.
  for (int v = 0; v < view.frame.depth_m.height(); ++v)
    for (int u = 0; u < view.frame.depth_m.width(); ++u)
      if (v < 380) view.frame.depth_m(u, v) = std::numeric_limits<float>::quiet_NaN();
  EXPECT_FALSE(find_object_region(prepare_view(view.frame)).has_value());
  for (float& z : view.frame.depth_m.data()) z = std::numeric_limits<float>::quiet_NaN();
  EXPECT_FALSE(find_object_region(prepare_view(view.frame)).has_value());
}

TEST(ObjectRegion, MovesWithItsFrame) {
  ObjectRegion region;
  region.plane = {Eigen::Vector3d(0, 0.6, 0.8), 0.3};
  region.foot = 0.3 * region.plane.normal;
  const Rigid3 motion =
      Rigid3::from_translation({0.1, -0.2, 0.5}) * Rigid3::from_axis_angle(Eigen::Vector3d(1, 2, 3), 0.7);
  const ObjectRegion moved = transform(motion, region);
  const Eigen::Vector3d p(0.3, 0.1, 0.9);
  EXPECT_NEAR(moved.plane.height_m(motion * p), region.plane.height_m(p), 1e-12);
  EXPECT_NEAR(moved.axis_distance_m(motion * p), region.axis_distance_m(p), 1e-12);
}

TEST(SegmentObject, LeavesOutTheSupportWhatIsBesideAndSpecks) {
  const Camera camera{100, 80, 100, 100, 49.5, 39.5};
  Image<float> depth(100, 80, 1.0F);  // A wall as the support: its normal points towards the camera.
  for (int v = 20; v < 50; ++v)
    for (int u = 30; u < 60; ++u) depth(u, v) = 0.95F;
  depth(5, 5) = 0.95F;  // An isolated pixel.
  for (int v = 60; v < 70; ++v)
    for (int u = 85; u < 95; ++u) depth(u, v) = 0.95F;  // Another object, outside the cylinder.
  ObjectRegion region;
  region.plane = {-Eigen::Vector3d::UnitZ(), -1.0};
  region.foot = {0, 0, 1.0};
  region.radius_m = 0.4;
  region.height_m = 0.2;
  const Image<std::uint8_t> mask = segment_object(back_project(camera, depth), region);
  for (int v = 0; v < 80; ++v)
    for (int u = 0; u < 100; ++u) EXPECT_EQ(mask(u, v) != 0, u >= 30 && u < 60 && v >= 20 && v < 50) << u << " " << v;
}

TEST(ObjectRegion, RefusesBadOptions) {
  ObjectRegionOptions options;
  options.max_jump_m = 0;
  EXPECT_THROW(options.check(), std::invalid_argument);
  SegmentObjectOptions segment;
  segment.max_gap_px = 0;
  EXPECT_THROW(segment.check(), std::invalid_argument);
}

}  // namespace
}  // namespace resight
