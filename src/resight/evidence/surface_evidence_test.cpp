// SPDX-License-Identifier: Apache-2.0
#include "resight/evidence/surface_evidence.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <optional>
#include <stdexcept>
#include <vector>

#include "resight/core/random.hpp"
#include "resight/sensor/noise_model.hpp"

namespace resight {
namespace {

using Points = std::vector<Eigen::Vector3f>;
constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
const Camera kCamera{32, 24, 30, 31, 14, 12.5};

Image<float> random_depth(std::uint64_t seed) {
  Image<float> depth_m(kCamera.width, kCamera.height);
  Rng rng(seed);
  for (float& z : depth_m.data()) z = rng.uniform() < 0.3 ? kNaN : static_cast<float>(rng.uniform(0.8, 2.2));
  return depth_m;
}

Points random_points(std::size_t count, double extent_m, std::uint64_t seed) {
  Rng rng(seed);
  Points points(count);
  for (Eigen::Vector3f& p : points)
    for (int axis = 0; axis < 3; ++axis) p[axis] = static_cast<float>(rng.uniform(-extent_m, extent_m));
  return points;
}

Points random_normals(std::size_t count, std::uint64_t seed) {
  Points normals = random_points(count, 1, seed);
  for (Eigen::Vector3f& n : normals) n.normalize();
  return normals;
}

/// Asks every pixel of the image, without the arithmetic of windows.
Evidence classify_slowly(const Eigen::Vector3f& p, const Image<float>& depth_m, const SurfaceEvidenceOptions& options) {
  if (!p.allFinite() || p.z() <= 0) return Evidence::kUnobserved;
  const Eigen::Vector2d position_px = kCamera.project(p.cast<double>());
  if (!kCamera.contains(position_px)) return Evidence::kUnobserved;
  bool any = false;
  bool all_behind = true;
  bool any_in_front = false;
  const double margin_m =
      options.margin.base_m + options.margin.noise_sigmas * nguyen_noise(p.z(), 0, kCamera.fx).axial_m;
  for (int v = 0; v < kCamera.height; ++v)
    for (int u = 0; u < kCamera.width; ++u) {
      if (std::abs(u - std::floor(position_px.x() + 0.5)) > options.window_radius_px) continue;
      if (std::abs(v - std::floor(position_px.y() + 0.5)) > options.window_radius_px) continue;
      if (std::isnan(depth_m(u, v))) continue;
      any = true;
      all_behind = all_behind && depth_m(u, v) > p.z() + margin_m;
      any_in_front = any_in_front || depth_m(u, v) < p.z() - margin_m;
    }
  if (!any) return Evidence::kUnobserved;
  if (any_in_front) return Evidence::kOccluded;
  return all_behind ? Evidence::kSeenThrough : Evidence::kPresent;
}

/// What the view says about the place of pixel (u, v) at a depth, in front of a wall at 2 m.
Evidence ask_wall(const Eigen::Vector3d& p_in_camera, const SurfaceEvidenceOptions& options = {}) {
  const Image<float> wall(kCamera.width, kCamera.height, 2.0F);
  const Points points{p_in_camera.cast<float>()};
  return classify_surface({.points = points}, Rigid3::identity(), {kCamera, wall}, options).points.front();
}

TEST(ClassifySurface, AgreesWithAllPixels) {
  const Image<float> depth_m = random_depth(4);
  Points queries = random_points(10000, 2.5, 5);
  queries[0] = {kNaN, 0, 1};
  queries[1] = {0, 0, kNaN};
  queries[2] = {0, 0, 0};
  for (const int radius : {0, 1, 2}) {
    const SurfaceEvidenceOptions options{.margin = {.base_m = 0.15, .noise_sigmas = 2}, .window_radius_px = radius};
    const SurfaceEvidence evidence =
        classify_surface({.points = queries}, Rigid3::identity(), {kCamera, depth_m}, options);
    ASSERT_EQ(evidence.points.size(), queries.size());
    for (std::size_t i = 0; i < queries.size(); ++i)
      EXPECT_EQ(evidence.points[i], classify_slowly(queries[i], depth_m, options)) << i;
    for (const int n : evidence.count) EXPECT_GT(n, 5) << "radius " << radius;
    EXPECT_EQ(evidence.count[0] + evidence.count[1] + evidence.count[2] + evidence.count[3], 10000);
  }
}

TEST(ClassifySurface, IsClassifyPointOfWhatFacesTheCamera) {
  const Image<float> depth_m = random_depth(1);
  const DepthImage view{kCamera, depth_m};
  const Points points = random_points(3000, 1, 2);
  const Points normals = random_normals(points.size(), 3);
  const Rigid3 pose = Rigid3::from_translation({0.1, 0, 1.5}) * Rigid3::from_axis_angle(Eigen::Vector3d(1, 2, 3), 0.7);
  const SurfaceEvidenceOptions options{.margin = {.base_m = 0.2}, .window_radius_px = 1, .min_viewing_cosine = 0.3};
  const SurfaceEvidence evidence = classify_surface({points, normals}, pose, view, options);
  std::array<int, 4> count{};
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::Vector3f p = Rigid3f(pose) * points[i];
    const double cosine = -(pose.rotation * normals[i].cast<double>()).dot(p.cast<double>().normalized());
    if (std::abs(cosine - 0.3) < 1e-6) continue;
    const bool faces = cosine > 0.3;
    EXPECT_EQ(evidence.points[i], faces ? classify_point(p, view, options.margin, 1) : Evidence::kUnobserved) << i;
    if (faces) ++count[static_cast<std::size_t>(evidence.points[i])];
  }
  EXPECT_EQ(evidence.count, count);
  EXPECT_GT(evidence.num(Evidence::kPresent), 20);
}

TEST(ClassifySurface, FourAnswersAndTheMargin) {
  const SurfaceEvidenceOptions exact{.margin = {.base_m = 0.125, .noise_sigmas = 0}};
  EXPECT_EQ(ask_wall({0, 0, 1.875}, exact), Evidence::kPresent);  // The margin itself is within it.
  EXPECT_EQ(ask_wall({0, 0, 2.125}, exact), Evidence::kPresent);
  EXPECT_EQ(ask_wall({0, 0, 1.874}, exact), Evidence::kSeenThrough);
  EXPECT_EQ(ask_wall({0, 0, 2.126}, exact), Evidence::kOccluded);
  EXPECT_EQ(ask_wall({0, 0, -1}, exact), Evidence::kUnobserved);
  EXPECT_EQ(ask_wall({0, 0, 0}, exact), Evidence::kUnobserved);
  EXPECT_EQ(ask_wall({5, 0, 1}, exact), Evidence::kUnobserved);
  const double sigma_m = nguyen_noise(1.9, 0, kCamera.fx).axial_m;
  EXPECT_EQ(ask_wall({0, 0, 1.9}, {.margin = {.base_m = 0, .noise_sigmas = 0.101 / sigma_m}}), Evidence::kPresent);
  EXPECT_EQ(ask_wall({0, 0, 1.9}, {.margin = {.base_m = 0, .noise_sigmas = 0.099 / sigma_m}}), Evidence::kSeenThrough);
}

TEST(ClassifySurface, NoReturnIsNoEvidence) {
  const Image<float> nothing(kCamera.width, kCamera.height, kNaN);
  const Points points = random_points(500, 2, 7);
  for (const int radius : {0, 3})
    for (const Evidence e : classify_surface({.points = points}, Rigid3::from_translation({0, 0, 2}),
                                             {kCamera, nothing}, {.window_radius_px = radius})
                                .points)
      EXPECT_EQ(e, Evidence::kUnobserved);
}

TEST(ClassifySurface, BordersOfTheImage) {
  for (const int radius : {0, 1}) {
    const SurfaceEvidenceOptions options{.window_radius_px = radius};
    EXPECT_EQ(ask_wall(kCamera.unproject(-0.49, -0.49, 1), options), Evidence::kSeenThrough);
    EXPECT_EQ(ask_wall(kCamera.unproject(31.49, 23.49, 1), options), Evidence::kSeenThrough);
    EXPECT_EQ(ask_wall(kCamera.unproject(-0.51, 1, 1), options), Evidence::kUnobserved);
    EXPECT_EQ(ask_wall(kCamera.unproject(1, 23.51, 1), options), Evidence::kUnobserved);
  }
}

TEST(ClassifySurface, ALargerWindowOnlyProtects) {  // More returns can only be nearer.
  const Image<float> depth_m = random_depth(11);
  const Points points = random_points(5000, 2, 12);
  const auto classify = [&](int radius) {
    return classify_surface({.points = points}, Rigid3::identity(), {kCamera, depth_m}, {.window_radius_px = radius});
  };
  const SurfaceEvidence narrow = classify(0), wide = classify(2);
  for (std::size_t i = 0; i < points.size(); ++i) {
    EXPECT_TRUE(narrow.points[i] != Evidence::kOccluded || wide.points[i] == Evidence::kOccluded);
    EXPECT_TRUE(narrow.points[i] != Evidence::kPresent || wide.points[i] != Evidence::kSeenThrough);
  }
}

TEST(ClassifySurface, ASurfaceHidesItselfIfAsked) {
  // A board at 1 m and, behind its left half, another at 1.1 m; the wall is at 2 m.
  const Image<float> wall(kCamera.width, kCamera.height, 2.0F);
  Points points;
  for (int i = -20; i <= 20; ++i)
    for (int j = -20; j <= 20; ++j) {
      points.emplace_back(0.005F * static_cast<float>(i), 0.005F * static_cast<float>(j), 1.0F);
      points.emplace_back(0.005F * static_cast<float>(i - 20), 0.005F * static_cast<float>(j), 1.1F);
    }
  SurfaceEvidenceOptions options;
  const auto classify = [&] {
    return classify_surface({.points = points}, Rigid3::identity(), {kCamera, wall}, options);
  };
  const SurfaceEvidence open = classify();
  EXPECT_EQ(open.num(Evidence::kSeenThrough), static_cast<int>(points.size()));
  options.self_occlusion_spacing_m = 0.005;
  const SurfaceEvidence hidden = classify();
  int num_hidden = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const bool is_rear = points[i].z() > 1.05F;
    const float x_on_front = points[i].x() / points[i].z();
    EXPECT_TRUE(is_rear || hidden.points[i] == Evidence::kSeenThrough);
    if (!is_rear || std::abs(x_on_front + 0.1F) < 0.05F || std::abs(points[i].y()) > 0.05F) continue;
    const bool is_behind = x_on_front > -0.1F;
    EXPECT_EQ(hidden.points[i], is_behind ? Evidence::kOccluded : Evidence::kSeenThrough);
    num_hidden += is_behind ? 1 : 0;
  }
  EXPECT_GT(num_hidden, 50);
  const Image<float> no_depth(wall.width(), wall.height(), std::numeric_limits<float>::quiet_NaN());
  const SurfaceEvidence blind = classify_surface({.points = points}, Rigid3::identity(), {kCamera, no_depth}, options);
  for (std::size_t i = 0; i < points.size(); ++i)
    EXPECT_EQ(blind.points[i], hidden.points[i] == Evidence::kOccluded ? Evidence::kOccluded : Evidence::kUnobserved);
  options.self_occlusion_spacing_m = -1;
  EXPECT_THROW((void)classify(), std::invalid_argument);
}

// A large object reaches beside the camera.
TEST(ClassifySurface, WhatIsBesideTheImageHidesNothing) {
  const Image<float> wall(kCamera.width, kCamera.height, 2.0F);
  Points points{{1, 0, 0.002F}};
  for (int i = 1; i <= 20; ++i)
    for (int j = -20; j <= 20; ++j) {
      points.emplace_back(-0.005F * static_cast<float>(i), 0.005F * static_cast<float>(j), 1.0F);
      points.emplace_back(0.006F * static_cast<float>(i), 0.005F * static_cast<float>(j), 1.2F);
    }
  const SurfaceEvidence evidence =
      classify_surface({.points = points}, Rigid3::identity(), {kCamera, wall}, {.self_occlusion_spacing_m = 0.005});
  EXPECT_EQ(evidence.num(Evidence::kSeenThrough), static_cast<int>(points.size()) - 1);
}

TEST(ClassifySurface, SelfOcclusionTurnsPointsToOccludedAndNothingElse) {
  const Image<float> depth_m = random_depth(21);
  const Points points = random_points(4000, 0.4, 22);
  const Points normals = random_normals(points.size(), 23);
  const Rigid3 pose = Rigid3::from_translation({0, 0, 1.5});
  const auto classify = [&](std::optional<double> spacing_m, int num_threads) {
    return classify_surface({points, normals}, pose, {kCamera, depth_m},
                            {.self_occlusion_spacing_m = spacing_m, .num_threads = num_threads});
  };
  const SurfaceEvidence open = classify({}, 1), hiding = classify(0.02, 1);
  EXPECT_EQ(classify(0.02, 3).points, hiding.points);
  int num_changed = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    EXPECT_EQ(open.viewing_cosine[i], hiding.viewing_cosine[i]);
    if (open.points[i] == hiding.points[i]) continue;
    ++num_changed;
    EXPECT_EQ(hiding.points[i], Evidence::kOccluded);
  }
  EXPECT_GT(num_changed, 50);
}

TEST(ClassifySurface, AnyNumberOfThreads) {
  const Image<float> depth_m = random_depth(8);
  const Points points = random_points(30000, 1.5, 9);
  const Points normals = random_normals(points.size(), 10);
  const auto classify = [&](int num_threads) {
    return classify_surface({points, normals}, Rigid3::from_translation({0, 0, 1}), {kCamera, depth_m},
                            {.num_threads = num_threads});
  };
  const SurfaceEvidence serial = classify(1);
  for (const int num_threads : {2, 3, 7}) {
    EXPECT_EQ(classify(num_threads).points, serial.points);
    EXPECT_EQ(classify(num_threads).count, serial.count);
  }
}

TEST(ClassifySurface, RefusesNonsense) {
  const Points points{{0, 0, 1}};
  const Image<float> depth_m(kCamera.width, kCamera.height, 1.0F);
  const Points two_normals(2, Eigen::Vector3f::UnitZ());
  const auto refuses = [&](const OrientedPoints& surface, const Camera& camera, const SurfaceEvidenceOptions& options) {
    EXPECT_THROW((void)classify_surface(surface, Rigid3::identity(), {camera, depth_m}, options),
                 std::invalid_argument);
  };
  EXPECT_NO_THROW((void)classify_surface({.points = points}, Rigid3::identity(), {kCamera, depth_m}));
  refuses({.points = points}, make_kinect_camera(), {});
  refuses({points, two_normals}, kCamera, {});
  refuses({.points = points}, kCamera, {.window_radius_px = -1});
  refuses({.points = points}, kCamera, {.margin = {.base_m = -1}});
  refuses({.points = points}, kCamera, {.margin = {.noise_sigmas = kNaN}});
  refuses({.points = points}, kCamera, {.min_viewing_cosine = 2});
  refuses({.points = points}, kCamera, {.num_threads = 0});
}

TEST(NearestDepth, IsTheSmallestReturnOfTheWindow) {
  Image<float> depth_m(kCamera.width, kCamera.height, kNaN);
  const DepthImage view{kCamera, depth_m};
  const Eigen::Vector3f p = kCamera.unproject(10, 10, 1).cast<float>();
  EXPECT_TRUE(std::isnan(nearest_depth(p, view, 1)));
  depth_m(11, 9) = 1.5F;
  depth_m(12, 10) = 0.5F;
  EXPECT_TRUE(std::isnan(nearest_depth(p, view, 0)));
  EXPECT_EQ(nearest_depth(p, view, 1), 1.5F);
  EXPECT_EQ(nearest_depth(p, view, 2), 0.5F);
  EXPECT_TRUE(std::isnan(nearest_depth(-p, view, 2)));
}

}  // namespace
}  // namespace resight
