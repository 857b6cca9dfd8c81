// SPDX-License-Identifier: Apache-2.0
#include "resight/sensor/reduce_frame.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "resight/sensor/prepared_view.hpp"
#include "resight/sensor/testing/memory_sequence.hpp"

namespace resight {
namespace {

constexpr float kHole = std::numeric_limits<float>::quiet_NaN();

/// A slanted plane: depth is linear in the inverse, so each pixel has its own.
RgbdFrame slanted_plane(int width, int height) {
  RgbdFrame frame{"plane", {width, height, 400, 410, 0.4 * width, 0.6 * height}, {}, {}, {}};
  frame.color = Image<Rgb8>(width, height, {10, 20, 30});
  frame.depth_m = Image<float>(width, height);
  for (int v = 0; v < height; ++v)
    for (int u = 0; u < width; ++u) frame.depth_m(u, v) = 1 / (1 + 1e-4F * static_cast<float>(u + 2 * v));
  return frame;
}

TEST(FindReduction, IsTheSmallestThatSuffices) {
  Camera camera = make_kinect_camera();
  EXPECT_EQ(find_reduction(camera, 640 * 480), 1);
  EXPECT_EQ(find_reduction(camera, 640 * 480 - 1), 2);
  EXPECT_EQ(find_reduction(camera, 320 * 240), 2);
  EXPECT_EQ(find_reduction(camera, 320 * 240 - 1), 3);
  camera.width = 1 << 24;
  camera.height = 1;
  EXPECT_EQ(find_reduction(camera, 1 << 21), 1);  // A row remains a row.
}

TEST(ReduceFrame, PointsStayOnTheirPlane) {
  const RgbdFrame frame = slanted_plane(67, 50);
  const RgbdFrame reduced = reduce_frame(frame, 3);
  ASSERT_TRUE(check_frame(reduced).ok()) << check_frame(reduced).error().message;
  ASSERT_EQ(reduced.camera.width, 22);
  ASSERT_EQ(reduced.camera.height, 16);
  // With three pixels a side, the median is the depth of the middle one, which is on the ray of the reduced pixel.
  for (int v = 0; v < reduced.camera.height; ++v)
    for (int u = 0; u < reduced.camera.width; ++u) {
      ASSERT_EQ(reduced.depth_m(u, v), frame.depth_m(3 * u + 1, 3 * v + 1)) << u << " " << v;
      const Eigen::Vector3d expected = frame.camera.unproject(3 * u + 1, 3 * v + 1, 1);
      ASSERT_LT((reduced.camera.unproject(u, v, 1) - expected).norm(), 1e-12);
      ASSERT_EQ(reduced.color(u, v), (Rgb8{10, 20, 30}));
    }
}

TEST(ReduceFrame, ColoursAreMeansAndDepthsAreMeasured) {
  RgbdFrame frame = slanted_plane(4, 2);
  frame.color(0, 0) = {255, 0, 31};
  frame.depth_m = Image<float>(4, 2, {1, 3, 2, kHole, 3, kHole, kHole, kHole});
  const RgbdFrame reduced = reduce_frame(frame, 2);
  EXPECT_EQ(reduced.color(0, 0), (Rgb8{71, 15, 30}));
  EXPECT_EQ(reduced.depth_m(0, 0), 3);  // Neither object nor background is moved.
  EXPECT_TRUE(std::isnan(reduced.depth_m(1, 0)));
  EXPECT_THROW((void)reduce_frame(frame, 3), std::invalid_argument);
  EXPECT_THROW((void)reduce_frame(frame, 0), std::invalid_argument);
}

TEST(EnlargeMask, EachPixelBecomesItsBlock) {
  Image<std::uint8_t> mask(2, 1, 0);
  mask(1, 0) = 7;
  const Image<std::uint8_t> large = enlarge_mask(mask, 3, 7, 5);
  EXPECT_EQ(large.width(), 7);
  for (int v = 0; v < 5; ++v)
    for (int u = 0; u < 7; ++u) EXPECT_EQ(large(u, v), v < 3 && u >= 3 && u < 6 ? 7 : 0) << u << ' ' << v;
  EXPECT_THROW((void)enlarge_mask(mask, 4, 7, 5), std::invalid_argument);
}

TEST(ReadReducedView, LargeViewsAreReduced) {
  const test::MemorySequence sequence({slanted_plane(67, 50), slanted_plane(30, 50), RgbdFrame{}});
  EXPECT_EQ(read_reduced_view(sequence, 0, 3000)->camera.width, 33);
  EXPECT_EQ(read_reduced_view(sequence, 1, 3000)->depth_m, slanted_plane(30, 50).depth_m);
  EXPECT_FALSE(read_reduced_view(sequence, 2, 3000).ok());
}

TEST(PrepareView, LargeViewsAreReduced) {
  PrepareViewOptions options;
  options.max_pixels = 3000;
  EXPECT_EQ(prepare_view(slanted_plane(67, 50), options).frame.camera.width, 33);
  options.max_pixels = 67 * 50;
  EXPECT_EQ(prepare_view(slanted_plane(67, 50), options).frame.depth_m, slanted_plane(67, 50).depth_m);
  options.max_pixels.reset();
  EXPECT_EQ(prepare_view(slanted_plane(67, 50), options).frame.camera.width, 67);
}

}  // namespace
}  // namespace resight
