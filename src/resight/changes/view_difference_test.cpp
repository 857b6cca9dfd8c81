// SPDX-License-Identifier: Apache-2.0
#include "resight/changes/view_difference.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <stdexcept>

#include "resight/changes/analytic_scene_test_util.hpp"
#include "resight/core/random.hpp"

namespace resight {
namespace {

using namespace testing_scene;
using Points = std::vector<Eigen::Vector3f>;

PreparedView view_of_boxes() {
  Scene scene = table();
  scene.boxes = {{{0, 0, 0.1}, {0.12, 0.05, 0.1}, 0.4}, {{0.25, -0.3, 0.15}, {0.03, 0.03, 0.15}}};
  return see(scene, look_at({0, -0.7, 0.5}, {0, 0, 0.05}), {160, 120, 131.25, 131.25, 79.5, 59.5});
}

/// Every fifth measurement moved by up to 4 cm, points anywhere, and what is no point.
Points points_about(const PreparedView& view, std::uint64_t seed) {
  Rng rng(seed);
  const auto next = [&](double extent) { return static_cast<float>(rng.uniform(-extent, extent)); };
  Points points;
  for (std::size_t i = 0; i < view.cloud.z.size(); i += 5)
    if (view.cloud.has_point(i))
      points.push_back(view.cloud.point(i) + Eigen::Vector3f(next(0.04), next(0.04), next(0.04)));
  for (int i = 0; i < 500; ++i) points.emplace_back(next(2), next(2), next(2));
  points.insert(points.end(),
                {{kNoDepth, 0, 1}, {0, 0, kNoDepth}, {kNoDepth, kNoDepth, kNoDepth}, {0, 0, 0}, {0, 0, -1}});
  return points;
}

bool is_within(const Eigen::Vector3f& a, const Eigen::Vector3f& b, double distance_m) {
  const auto limit = static_cast<float>(distance_m);
  return (a - b).squaredNorm() <= limit * limit;
}

std::vector<std::uint8_t> explained_points_slowly(const Points& points, const OrganizedCloud& view,
                                                  double tolerance_m) {
  std::vector<std::uint8_t> explained;
  for (const Eigen::Vector3f& p : points) {
    bool found = false;
    for (std::size_t i = 0; i < view.z.size() && !found; ++i) found = is_within(view.point(i), p, tolerance_m);
    explained.push_back(found ? 1 : 0);
  }
  return explained;
}

std::vector<int> unexplained_pixels_slowly(const Points& points, const OrganizedCloud& view, double tolerance_m) {
  std::vector<int> pixels;
  for (std::size_t i = 0; i < view.z.size(); ++i) {
    if (!view.has_point(i)) continue;
    const Eigen::Vector3f q = view.point(i);
    if (std::ranges::none_of(points, [&](const auto& p) { return is_within(p, q, tolerance_m); }))
      pixels.push_back(static_cast<int>(i));
  }
  return pixels;
}

constexpr double kTolerances_m[] = {0.01, 0.02, 0.08};

TEST(FindExplainedPoints, AgreesWithBruteForce) {
  const PreparedView view = view_of_boxes();
  const Points points = points_about(view, 1);
  for (const double tolerance_m : kTolerances_m) {
    const auto expected = explained_points_slowly(points, view.cloud, tolerance_m);
    EXPECT_GT(std::ranges::count(expected, 1), 100);
    EXPECT_GT(std::ranges::count(expected, 0), 100);
    EXPECT_EQ(find_explained_points(points, view.cloud, view.frame.camera, tolerance_m), expected);
  }
}

TEST(FindExplainedPoints, MarksOnlyPixelsThatHaveAPoint) {
  const PreparedView view = view_of_boxes();
  const Points points = points_about(view, 2);
  const double tolerance_m = 0.02;
  Image<std::uint8_t> marked(view.cloud.width(), view.cloud.height());
  (void)find_explained_points(points, view.cloud, view.frame.camera, tolerance_m, 2, &marked);
  EXPECT_GT(std::ranges::count(marked.data(), 1), 1000);
  for (const int i : unexplained_pixels_slowly(points, view.cloud, tolerance_m))
    EXPECT_EQ(marked[static_cast<std::size_t>(i)], 0);
}

TEST(FindUnexplainedPixels, AgreesWithBruteForceWithAndWithoutMarks) {
  const PreparedView view = view_of_boxes();
  Points points = points_about(view, 3);
  std::erase_if(points, [](const Eigen::Vector3f& p) { return p.x() > 0.1F; });  // a part is new
  for (const double tolerance_m : kTolerances_m) {
    const auto expected = unexplained_pixels_slowly(points, view.cloud, tolerance_m);
    EXPECT_GT(expected.size(), 100U);
    EXPECT_LT(expected.size() + 100, view.cloud.z.size());
    Image<std::uint8_t> marked(view.cloud.width(), view.cloud.height());
    (void)find_explained_points(points, view.cloud, view.frame.camera, tolerance_m, 1, &marked);
    EXPECT_EQ(find_unexplained_pixels(points, view.cloud, view.frame.camera, tolerance_m), expected);
    EXPECT_EQ(find_unexplained_pixels(points, view.cloud, view.frame.camera, tolerance_m, 2, marked), expected);
  }
}

TEST(FindPixelsNear, AgreesWithBruteForce) {
  const PreparedView view = view_of_boxes();
  const Points all = points_about(view, 4);
  for (const std::size_t count : {std::size_t{0}, std::size_t{3}, all.size()}) {
    const Points points(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(count));
    std::vector<int> expected;
    for (std::size_t i = 0; i < view.cloud.z.size(); ++i)
      if (std::ranges::any_of(points, [&](const auto& p) { return is_within(p, view.cloud.point(i), 0.03); }))
        expected.push_back(static_cast<int>(i));
    EXPECT_EQ(expected.empty(), count == 0);
    EXPECT_EQ(find_pixels_near(points, view.cloud, view.frame.camera, 0.03), expected);
  }
}

TEST(ViewDifference, SerialIsParallel) {
  const PreparedView view = see(table());
  const Points points = points_about(view, 5);
  ASSERT_GT(points.size(), 10000U);  // several blocks
  const Camera& camera = view.frame.camera;
  EXPECT_EQ(find_explained_points(points, view.cloud, camera, 0.02, 3),
            find_explained_points(points, view.cloud, camera, 0.02));
  EXPECT_EQ(find_unexplained_pixels(points, view.cloud, camera, 0.02, 3),
            find_unexplained_pixels(points, view.cloud, camera, 0.02));
  EXPECT_EQ(find_pixels_near(points, view.cloud, camera, 0.02, 3), find_pixels_near(points, view.cloud, camera, 0.02));
}

TEST(ViewDifference, RefusesNonsense) {
  const PreparedView view = view_of_boxes();
  const Camera& camera = view.frame.camera;
  Image<std::uint8_t> small(3, 3);
  EXPECT_THROW((void)find_explained_points({}, view.cloud, camera, 0), std::invalid_argument);
  EXPECT_THROW((void)find_explained_points({}, view.cloud, small_camera(), {}), std::invalid_argument);
  EXPECT_THROW((void)find_explained_points({}, view.cloud, camera, 0.02, 1, &small), std::invalid_argument);
  EXPECT_THROW((void)find_unexplained_pixels({}, view.cloud, camera, 0.02, 1, small), std::invalid_argument);
  EXPECT_THROW((void)find_pixels_near({}, view.cloud, camera, 0), std::invalid_argument);
}

}  // namespace
}  // namespace resight
