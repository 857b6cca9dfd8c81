// SPDX-License-Identifier: Apache-2.0
#include "resight/changes/depth_tiles.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <stdexcept>

#include "resight/changes/analytic_scene_test_util.hpp"
#include "resight/core/random.hpp"

namespace resight {
namespace {

using Points = std::vector<Eigen::Vector3f>;

/// In clumps of a few centimetres, anywhere around the camera, also behind it and outside the image.
Points clumps(int count, std::uint64_t seed) {
  Rng rng(seed);
  Points points;
  Eigen::Vector3d center = Eigen::Vector3d::Zero();
  for (int i = 0; i < count; ++i) {
    if (i % 8 == 0) center = {rng.uniform(-1.5, 1.5), rng.uniform(-1.5, 1.5), rng.uniform(-0.2, 2)};
    points.push_back(
        (center + 0.03 * Eigen::Vector3d{rng.uniform(-1, 1), rng.uniform(-1, 1), rng.uniform(-1, 1)}).cast<float>());
  }
  return points;
}

bool any_within(const Points& points, const Eigen::Vector3f& q, double radius_m) {
  return std::ranges::any_of(points, [&](const Eigen::Vector3f& p) { return (p - q).norm() <= radius_m; });
}

TEST(DepthTiles, NeverDenyWhatIsNear) {
  int num_near = 0;
  int num_denied = 0;
  for (const double radius_m : {0.005, 0.02, 0.3}) {
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
      const Points points = clumps(40, seed);
      Points queries = clumps(400, 100 + seed);
      for (const Eigen::Vector3f& p : points) queries.push_back(p * 1.01F);
      DepthTiles tiles(testing_scene::small_camera(), radius_m);
      for (const Eigen::Vector3f& p : points) tiles.add(p);
      tiles.close();
      for (const Eigen::Vector3f& q : queries) {
        const bool is_near = any_within(points, q, radius_m);
        if (is_near) {
          EXPECT_TRUE(tiles.may_be_near(q)) << q.transpose();
        }
        num_near += is_near ? 1 : 0;
        num_denied += tiles.may_be_near(q) ? 0 : 1;
      }
    }
  }
  EXPECT_GT(num_near, 1000);
  EXPECT_GT(num_denied, 5000);
}

TEST(DepthTiles, PixelsAreThePointsBehindThem) {
  const Camera camera = testing_scene::small_camera();
  DepthTiles of_pixels(camera, 0.02);
  DepthTiles of_points(camera, 0.02);
  Rng rng(3);
  for (int i = 0; i < 50; ++i) {
    // In the middle of tiles, for the rounding of a projection.
    const int u = 3 + 8 * static_cast<int>(rng.below(static_cast<std::uint64_t>(camera.width / 8)));
    const int v = 3 + 8 * static_cast<int>(rng.below(static_cast<std::uint64_t>(camera.height / 8)));
    const auto z = static_cast<float>(rng.uniform(0.4, 3));
    of_pixels.add_pixel(u, v, z);
    of_points.add(camera.unproject(u, v, z).cast<float>());
  }
  of_pixels.close();
  of_points.close();
  for (const Eigen::Vector3f& q : clumps(5000, 9)) EXPECT_EQ(of_pixels.may_be_near(q), of_points.may_be_near(q));
}

TEST(DepthTiles, NothingIsNearToNothing) {
  DepthTiles tiles(testing_scene::small_camera(), 0.02);
  tiles.close();
  for (const Eigen::Vector3f& q : clumps(100, 5)) EXPECT_FALSE(tiles.may_be_near(q));
  const float nan = std::numeric_limits<float>::quiet_NaN();
  EXPECT_FALSE(tiles.may_be_near({nan, 0, 1}));
  EXPECT_FALSE(tiles.may_be_near({0, 0, nan}));
  EXPECT_THROW(DepthTiles(testing_scene::small_camera(), 0), std::invalid_argument);
  EXPECT_THROW(DepthTiles(Camera{}, 0.02), std::invalid_argument);
}

}  // namespace
}  // namespace resight
