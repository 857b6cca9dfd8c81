// SPDX-License-Identifier: Apache-2.0
#include "resight/evidence/view_comparison.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <stdexcept>
#include <utility>

#include "resight/core/random.hpp"

namespace resight {
namespace {

const Camera kTwoViewCamera{160, 120, 140, 140, 79.5, 59.5};

/// A wall across the view, at depth z = distance_m + slope * x, with noise of so many sigmas of the model.
PreparedView see_wall(double distance_m, double slope = 0, double noise = 0, std::uint64_t seed = 1,
                      const Rigid3& world_from_camera = Rigid3::identity()) {
  RgbdFrame frame{"wall", kTwoViewCamera, Image<Rgb8>(kTwoViewCamera.width, kTwoViewCamera.height),
                  Image<float>(kTwoViewCamera.width, kTwoViewCamera.height), world_from_camera};
  Rng rng(seed);
  for (int v = 0; v < kTwoViewCamera.height; ++v)
    for (int u = 0; u < kTwoViewCamera.width; ++u) {
      const double z = distance_m / (1 - slope * (u - kTwoViewCamera.cx) / kTwoViewCamera.fx);
      const double sigma_m = nguyen_noise(z, std::atan(slope), kTwoViewCamera.fx).axial_m;
      frame.depth_m(u, v) = static_cast<float>(z + noise * sigma_m * rng.normal());
    }
  return prepare_view(std::move(frame), {.normals = {.window_radius_px = 4}});
}

int count(const Image<Evidence>& evidence, Evidence kind) {
  return static_cast<int>(std::ranges::count(evidence.data(), kind));
}

constexpr int kNumPixels = 160 * 120;

/// The kind of all pixels in the middle, where the wall is seen head-on; none if they differ.
std::optional<Evidence> in_the_middle(const Image<Evidence>& evidence) {
  const Evidence kind = evidence(80, 60);
  for (int v = 50; v < 70; ++v)
    for (int u = 70; u < 90; ++u)
      if (evidence(u, v) != kind) return std::nullopt;
  return kind;
}

TEST(CompareViews, DepthBeyondTheNoiseContradicts) {
  const PreparedView surface = see_wall(1.0);
  // Both views have a sigma of 1.9 mm: the limit is 3 * sqrt(2) * 1.9 = 8 mm.
  EXPECT_EQ(count(compare_views(surface, see_wall(1.006), 1).evidence, Evidence::kPresent), kNumPixels);
  EXPECT_EQ(in_the_middle(compare_views(surface, see_wall(1.010), 1).evidence), Evidence::kSeenThrough);
  EXPECT_EQ(in_the_middle(compare_views(surface, see_wall(0.990), 1).evidence), Evidence::kOccluded);
  EXPECT_EQ(count(compare_views(surface, see_wall(1.010), 2).evidence, Evidence::kPresent), kNumPixels);
}

TEST(CompareViews, TheLimitGrowsWithTheRange) {
  EXPECT_EQ(count(compare_views(see_wall(3.0), see_wall(3.02), 1).evidence, Evidence::kPresent), kNumPixels);
  EXPECT_EQ(count(compare_views(see_wall(3.0), see_wall(3.10), 1).evidence, Evidence::kSeenThrough), kNumPixels);
}

TEST(CompareViews, DistancesAreAlongTheNormal) {
  // At 56 deg, 12 mm along the ray are 7 mm between the surfaces.
  EXPECT_EQ(in_the_middle(compare_views(see_wall(1.0), see_wall(1.012), 1).evidence), Evidence::kSeenThrough);
  EXPECT_EQ(in_the_middle(compare_views(see_wall(1.0, 1.5), see_wall(1.012, 1.5), 1).evidence), Evidence::kPresent);
}

TEST(CompareViews, AMovedCameraSeesTheSameSurface) {
  Rigid3 beside = Rigid3::identity();
  beside.translation.x() = 14.0 / kTwoViewCamera.fx;  // 14 px
  const PreparedView surface = see_wall(1.0);
  const Image<Evidence> evidence = compare_views(surface, see_wall(1.0, 0, 0, 1, beside), 1).evidence;
  EXPECT_EQ(count(evidence, Evidence::kPresent) + count(evidence, Evidence::kUnobserved), kNumPixels);
  EXPECT_NEAR(count(evidence, Evidence::kUnobserved), 14 * kTwoViewCamera.height, 2 * kTwoViewCamera.height);
}

TEST(CompareViews, TellsWhereSurfacesAreInTheOtherView) {
  const PreparedView surface = see_wall(1.2, 0.4);
  Rigid3 moved = Rigid3::identity();
  moved.translation = {0.11, -0.07, 0.2};
  moved.rotation = Eigen::AngleAxisd(0.3, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix();
  const PreparedView view = see_wall(1.0, 0.4, 0, 1, moved);
  const Image<int> pixels = compare_views(surface, view, 1).pixels;
  ASSERT_EQ(pixels.size(), surface.cloud.z.size());
  int num_visible = 0;
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    const Eigen::Vector3d p = moved.inverse() * surface.cloud.point(i).cast<double>().eval();
    const Eigen::Vector2d position_px = kTwoViewCamera.project(p);
    // Rounding may choose either pixel on the border between two.
    const Eigen::Vector2d from_border = ((position_px.array() + 0.5) - (position_px.array() + 0.5).round()).abs();
    if (from_border.minCoeff() < 1e-3) continue;
    const std::optional<Pixel> pixel = kTwoViewCamera.pixel_of(p);
    ASSERT_EQ(pixels[i], pixel ? static_cast<int>(pixels.index(pixel->u, pixel->v)) : -1) << i;
    num_visible += pixel ? 1 : 0;
  }
  EXPECT_GT(num_visible, kNumPixels / 4);
}

TEST(CompareViews, ANeighborExplainsAndContradicts) {
  PreparedView view = see_wall(1.5);
  view.frame.depth_m(80, 60) = 1.0F;
  const PreparedView surface = see_wall(1.0);
  EXPECT_EQ(compare_views(surface, view, 1, {.window_radius_px = 0}).evidence(81, 60), Evidence::kSeenThrough);
  EXPECT_EQ(compare_views(surface, view, 1, {.window_radius_px = 1}).evidence(81, 60), Evidence::kPresent);
  view.frame.depth_m(80, 60) = 0.7F;  // The edge of something in front: no evidence beside it.
  EXPECT_EQ(compare_views(surface, view, 1, {.window_radius_px = 1}).evidence(81, 60), Evidence::kUnobserved);
}

TEST(CompareViews, NoReturnIsNoEvidence) {
  PreparedView view = see_wall(1.5);
  std::ranges::fill(view.frame.depth_m.data(), std::numeric_limits<float>::quiet_NaN());
  EXPECT_EQ(count(compare_views(see_wall(1.0), view, 1).evidence, Evidence::kUnobserved), kNumPixels);
}

// 10 mm, of which sqrt(2) * 1.9 mm are one standard deviation.
TEST(CompareViews, AContradictionCountsFromTheLimitToTwiceTheLimit) {
  const auto contradiction = [](double distance_m, double noise_scale, double sigmas) {
    return compare_views(see_wall(1.0), see_wall(distance_m), noise_scale, {.sigmas = sigmas}).contradiction(80, 60);
  };
  EXPECT_NEAR(contradiction(1.01, 1, 3), 3.72 / 3 - 1, 0.03);
  EXPECT_NEAR(contradiction(1.01, 1, 2.5), 3.72 / 2.5 - 1, 0.03);
  EXPECT_NEAR(contradiction(1.01, 1.2, 2.5), 3.72 / 1.2 / 2.5 - 1, 0.03);
  EXPECT_EQ(contradiction(1.10, 1, 3), 1);
  EXPECT_EQ(contradiction(1.006, 1, 3), 0) << "present";
  EXPECT_EQ(contradiction(0.99, 1, 3), 0) << "occluded";
}

constexpr Rgb8 kTable{180, 130, 90}, kPlate{230, 230, 225};
bool is_plate(int u, int v) { return std::hypot(u - 80, v - 60) < 30; }

/// A table at 1 m, seen from above, with or without a plate of this height and colour.
PreparedView see_table(double plate_height_m, Rgb8 plate_color, std::uint64_t seed) {
  RgbdFrame frame = see_wall(1.0, 0, 1, seed).frame;
  for (int v = 0; v < kTwoViewCamera.height; ++v)
    for (int u = 0; u < kTwoViewCamera.width; ++u) {
      frame.color(u, v) = is_plate(u, v) ? plate_color : kTable;
      if (is_plate(u, v)) frame.depth_m(u, v) -= static_cast<float>(plate_height_m);
    }
  return prepare_view(std::move(frame), {.normals = {.window_radius_px = 4}});
}

/// Shares of the pixels of the plate, and of the others, that are seen through.
std::pair<double, double> seen_through(const PreparedView& surfaces, const PreparedView& view,
                                       std::optional<double> recolored_sigmas) {
  const Image<Evidence> evidence =
      compare_views(surfaces, view, estimate_noise_scale(surfaces, view),
                    {.sigmas = 2.5, .recolored_sigmas = recolored_sigmas, .window_radius_px = 0})
          .evidence;
  double num_plate = 0, num_seen_plate = 0, num_seen_table = 0;
  for (int v = 0; v < kTwoViewCamera.height; ++v)
    for (int u = 0; u < kTwoViewCamera.width; ++u) {
      const double seen = evidence(u, v) == Evidence::kSeenThrough ? 1 : 0;
      num_plate += is_plate(u, v) ? 1 : 0;
      (is_plate(u, v) ? num_seen_plate : num_seen_table) += seen;
    }
  return {num_seen_plate / num_plate, num_seen_table / (kNumPixels - num_plate)};
}

// 4 mm are 1.5 standard deviations of a pixel. Noise alone exceeds these in 7 % of the pixels, and 2.5 in 0.6 %.
TEST(CompareViews, ALargeFlatThingOfAnotherColorIsSeenThrough) {
  const PreparedView table = see_table(0, kTable, 2);
  EXPECT_GT(seen_through(see_table(0.004, kPlate, 1), table, 1.5).first, 0.85);
  EXPECT_LT(seen_through(see_table(0.004, kPlate, 1), table, 1.5).second, 0.01);
  EXPECT_LT(seen_through(see_table(0.004, kPlate, 1), table, std::nullopt).first, 0.4) << "by depth alone";
  EXPECT_LT(seen_through(see_table(0.004, kTable, 1), table, 1.5).first, 0.4) << "of the same colour";
  EXPECT_LT(seen_through(see_table(0, kPlate, 1), table, 1.5).first, 0.1) << "colour alone: paint, or light";
}

TEST(CompareViews, TheContradictionOfAFlatThingIsThatOfItsMean) {
  const PreparedView plate = see_table(0.004, kPlate, 1), table = see_table(0, kTable, 2);
  const ViewComparison found = compare_views(plate, table, 1, {.sigmas = 2.5, .recolored_sigmas = 1.5});
  EXPECT_EQ(found.evidence(80, 60), Evidence::kSeenThrough);
  EXPECT_EQ(found.contradiction(80, 60), 1) << "many times the limit, although single pixels are below it";
}

TEST(CompareViews, SerialIsParallel) {
  const PreparedView surface = see_table(0.004, kPlate, 1), view = see_table(0, kTable, 2);
  const auto compare = [&](int num_threads) {
    return compare_views(surface, view, 1, {.recolored_sigmas = 1.5, .num_threads = num_threads});
  };
  const ViewComparison serial = compare(1), parallel = compare(3);
  EXPECT_EQ(serial.evidence, parallel.evidence);
  EXPECT_EQ(serial.pixels, parallel.pixels);
  EXPECT_EQ(serial.contradiction, parallel.contradiction);
}

TEST(EstimateNoiseScale, GrowsWithTheNoise) {
  const double once = estimate_noise_scale(see_wall(1.5, 0, 1, 1), see_wall(1.5, 0, 1, 2));
  const double twice = estimate_noise_scale(see_wall(1.5, 0, 2, 1), see_wall(1.5, 0, 2, 2));
  EXPECT_GT(once, 0.7);
  EXPECT_LT(once, 1.1);
  EXPECT_NEAR(twice / once, 2, 0.2);
}

TEST(EstimateNoiseScale, IsNotMovedByChangesAndHasALowerLimit) {
  PreparedView view = see_wall(1.5, 0, 1, 2);
  for (int v = 0; v < kTwoViewCamera.height / 4; ++v)
    for (int u = 0; u < kTwoViewCamera.width; ++u) view.frame.depth_m(u, v) -= 0.05F;
  EXPECT_LT(estimate_noise_scale(see_wall(1.5, 0, 1, 1), view), 1.6);
  const double exact = estimate_noise_scale(see_wall(1.5), see_wall(1.5));
  EXPECT_GT(exact, 0.5);
  EXPECT_LT(exact, 1);
}

/// A board 60 px wide in front of a wall, moved to the right by so many pixels. Nothing tells the pose that it moved.
PreparedView see_board(int shift_px, double board_m = 1.0) {
  RgbdFrame frame = see_wall(1.5).frame;
  for (int v = 30; v < 90; ++v)
    for (int u = 50; u < 110; ++u) frame.depth_m(u + shift_px, v) = static_cast<float>(board_m);
  return prepare_view(std::move(frame), {.normals = {.window_radius_px = 4}});
}

TEST(EstimateMisregistration, IsTheShiftOfContours) {
  EXPECT_EQ(estimate_misregistration_px(see_board(0), see_board(0), 1, 2.5), 0);
  for (const int shift_px : {1, 3, 6}) {
    EXPECT_EQ(estimate_misregistration_px(see_board(0), see_board(shift_px), 1, 2.5), shift_px);
    EXPECT_EQ(estimate_misregistration_px(see_board(shift_px), see_board(0), 1, 2.5), shift_px);
  }
}

TEST(EstimateMisregistration, IsNotMovedByChanges) {
  // Most contours are of something that was not there before.
  PreparedView before = see_board(0);
  RgbdFrame frame = before.frame;
  for (int v = 5; v < 115; ++v)
    for (int u = 5; u < 155; ++u)
      if (v < 25 || v >= 95 || u < 40 || u >= 120) frame.depth_m(u, v) = 0.7F;
  const PreparedView after = prepare_view(std::move(frame), {.normals = {.window_radius_px = 4}});
  EXPECT_EQ(estimate_misregistration_px(after, before, 1, 2.5), 0);
  EXPECT_EQ(estimate_misregistration_px(before, after, 1, 2.5), 0);
}

TEST(EstimateMisregistration, IsZeroWithoutContours) {
  EXPECT_EQ(estimate_misregistration_px(see_wall(1.0), see_wall(1.0), 1, 2.5), 0);
  EXPECT_EQ(estimate_misregistration_px(see_board(0), see_wall(1.5), 1, 2.5), 0);
}

TEST(CompareViews, RefusesNonsense) {
  const PreparedView view = see_wall(1.0);
  EXPECT_THROW((void)compare_views(view, view, 0), std::invalid_argument);
  EXPECT_THROW((void)compare_views(view, view, 1, {.sigmas = -1}), std::invalid_argument);
  EXPECT_THROW((void)compare_views(view, PreparedView{}, 1), std::invalid_argument);
}

}  // namespace
}  // namespace resight
