// SPDX-License-Identifier: Apache-2.0
#include "resight/verification/scene_preparation.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>

#include "resight/core/random.hpp"
#include "resight/verification/local_scene.hpp"
#include "resight/verification/testing/analytic_scene.hpp"

namespace resight {
namespace {

using namespace analytic;

PointCloud box_and_ball_scene() {
  World world;
  world.solids.push_back({Shape::kBox, {0.1, 0.08, 0.12}, plain({200, 0, 0}), on_table(0, 0, 0.06)});
  world.solids.push_back({Shape::kSphere, {0.12, 0.12, 0.12}, plain({0, 200, 0}), on_table(0.2, 0.1, 0.06)});
  return merge(render_all(world, circle_of_cameras(5)));
}

bool on_box_side(const Eigen::Vector3f& p, int axis, float at) {
  return std::abs(p[axis] - at) < 1e-3F && std::abs(p.x()) < 0.0505F && std::abs(p.y()) < 0.0405F && p.z() > 0.02F &&
         p.z() < 0.11F;
}

TEST(PrepareScene, SegmentsAreTheSmoothFaces) {
  const PreparedScene scene = prepare_scene(box_and_ball_scene(), {});
  std::set<int> faces;
  for (const auto& [axis, at] :
       {std::pair(0, 0.05F), std::pair(0, -0.05F), std::pair(1, 0.04F), std::pair(1, -0.04F)}) {
    std::map<int, int> votes;
    for (std::size_t i = 0; i < scene.points.size(); ++i)
      if (on_box_side(scene.points[i], axis, at) && std::abs(scene.normals[i][axis]) > 0.99F &&
          scene.points[i].head<2>().cwiseAbs().minCoeff() < 0.03F)
        ++votes[scene.segment[i]];
    ASSERT_FALSE(votes.empty());
    const auto best =
        std::max_element(votes.begin(), votes.end(), [](const auto& a, const auto& b) { return a.second < b.second; });
    EXPECT_GE(best->first, 0);
    EXPECT_GT(best->second, 150);
    faces.insert(best->first);
  }
  EXPECT_EQ(faces.size(), 4U);
  // The ball is one segment of its own.
  std::map<int, int> votes;
  int on_ball = 0;
  for (std::size_t i = 0; i < scene.points.size(); ++i)
    if ((scene.points[i] - Eigen::Vector3f(0.2F, 0.1F, 0.06F)).norm() < 0.065F && scene.points[i].z() > 0.02F) {
      ++votes[scene.segment[i]];
      ++on_ball;
    }
  const auto best =
      std::max_element(votes.begin(), votes.end(), [](const auto& a, const auto& b) { return a.second < b.second; });
  EXPECT_GE(best->first, 0);
  EXPECT_FALSE(faces.contains(best->first));
  EXPECT_GT(best->second, 0.95 * on_ball);
}

// Its bounding square has a diagonal of 1.4 diameters: no measure of a round face.
TEST(PrepareScene, ARoundFaceIsAsWideAsItsDiameter) {
  World world;
  world.solids.push_back({Shape::kCylinder, {0.3, 0.3, 0.06}, plain({200, 0, 0}), on_table(0, 0, 0.03)});
  const PreparedScene scene = prepare_scene(merge(render_all(world, circle_of_cameras(5))), {});
  const auto face = std::find_if(scene.planes.begin(), scene.planes.end(),
                                 [](const ScenePlane& plane) { return std::abs(plane.offset - 0.06F) < 2e-3F; });
  ASSERT_NE(face, scene.planes.end());
  EXPECT_NEAR(face->extent_m, 0.3, 0.02);
}

TEST(PrepareScene, PlanesOfTheDownsampledSceneAreTheSame) {
  VerifyOptions options;
  options.clutter.rule = ContinuationClutter{};
  const PreparedScene full = prepare_scene(box_and_ball_scene(), options);
  options.planes->spacing_m = 0.012;
  const PreparedScene quick = prepare_scene(box_and_ball_scene(), options);
  ASSERT_EQ(full.planes.size(), 1U);
  ASSERT_EQ(quick.planes.size(), 1U);
  EXPECT_GT(quick.planes[0].normal.dot(full.planes[0].normal), 0.99999F);
  EXPECT_NEAR(quick.planes[0].offset, full.planes[0].offset, 1e-3);
  EXPECT_NEAR(quick.planes[0].extent_m, full.planes[0].extent_m, 0.03);
  ASSERT_EQ(quick.plane.size(), full.plane.size());
  int num_on_plane = 0;
  int num_different = 0;
  for (std::size_t i = 0; i < full.plane.size(); ++i) {
    num_on_plane += full.plane[i] == 0 ? 1 : 0;
    num_different += full.plane[i] != quick.plane[i] ? 1 : 0;
  }
  EXPECT_GT(num_on_plane, 1000);
  EXPECT_LT(num_different, num_on_plane / 100);
}

TEST(LocalScene, ASubsetIsVisitedAsTheWholeIs) {
  const PreparedScene scene = prepare_scene(box_and_ball_scene(), {});
  const std::vector<Eigen::Vector3f> around = {{-0.05F, -0.05F, 0}, {0.05F, 0.05F, 0.12F}};
  const LocalScene whole(scene.points, scene.blocks, around, 0.04F, 0.01F);
  std::vector<std::uint8_t> kept;
  Rng rng(3);
  for (std::size_t i = 0; i < whole.size(); ++i) kept.push_back(rng.below(3) == 0 ? 1 : 0);
  const LocalScene subset = whole.subset(kept);
  EXPECT_EQ(subset.size(), static_cast<std::size_t>(std::count(kept.begin(), kept.end(), 1)));
  std::size_t num_visited = 0;
  for (const Eigen::Vector3f& query : {around[0], around[1], Eigen::Vector3f(0.05F, 0, 0.06F)}) {
    std::set<int> expected;
    whole.visit_within(query, 0.03F, [&](std::size_t i, float) {
      if (kept[i] != 0) expected.insert(whole.scene_index(i));
      return true;
    });
    std::set<int> visited;
    subset.visit_within(query, 0.03F,
                        [&](std::size_t i, float) { return visited.insert(subset.scene_index(i)).second; });
    EXPECT_EQ(visited, expected);
    num_visited += visited.size();
  }
  EXPECT_GT(num_visited, 20U);
}

TEST(PrepareScene, FindsTheTableAndNothingElse) {
  const PreparedScene scene = prepare_scene(box_and_ball_scene(), {});
  ASSERT_EQ(scene.planes.size(), 1U);
  const ScenePlane& table = scene.planes[0];
  EXPECT_GT(table.normal.z(), 0.9999F);
  EXPECT_NEAR(table.offset, 0, 1e-3);
  EXPECT_NEAR(table.extent_m, 1.2 * std::sqrt(2), 0.3);
  int on_table = 0;
  int found = 0;
  for (std::size_t i = 0; i < scene.points.size(); ++i) {
    if (std::abs(scene.points[i].z()) < 1e-4F) {
      ++on_table;
      if (scene.plane[i] == 0) ++found;
    }
    if (scene.points[i].z() > 0.0105F) {
      EXPECT_EQ(scene.plane[i], -1);
    }
  }
  EXPECT_GT(on_table, 10000);
  EXPECT_GT(found, 0.98 * on_table);
  EXPECT_TRUE(table.covers({0, 0, 0}));  // Under the box, where nothing was seen.
  EXPECT_TRUE(table.covers({0.3F, -0.3F, 0.1F}));
  EXPECT_FALSE(table.covers({0.8F, 0, 0}));
  EXPECT_TRUE(prepare_scene(box_and_ball_scene(), {.planes = {}}).planes.empty());
}

TEST(PrepareScene, PlanesFollowATiltedWorldAndNoise) {
  PointCloud cloud = box_and_ball_scene();
  Rng rng(5);
  for (Eigen::Vector3f& p : cloud.points)
    p += 0.002F * Eigen::Vector3f{static_cast<float>(rng.normal()), static_cast<float>(rng.normal()),
                                  static_cast<float>(rng.normal())};
  for (Eigen::Vector3f& n : cloud.normals)
    n = (n + 0.05F * Eigen::Vector3f{static_cast<float>(rng.normal()), static_cast<float>(rng.normal()),
                                     static_cast<float>(rng.normal())})
            .normalized();
  const Rigid3 tilt = Rigid3::from_translation({1, 2, 3}) * Rigid3::from_axis_angle({1, 2, 0.5}, 0.8);
  const PreparedScene scene = prepare_scene(transform(tilt, cloud), {});
  ASSERT_EQ(scene.planes.size(), 1U);
  EXPECT_GT(scene.planes[0].normal.dot((tilt.rotation * Eigen::Vector3d::UnitZ()).cast<float>()), 0.9995F);
  EXPECT_NEAR(scene.planes[0].signed_distance(tilt.translation.cast<float>()), 0, 2e-3);
}

TEST(PrepareScene, DoesNotDependOnTheNumberOfThreads) {
  const PreparedScene a = prepare_scene(box_and_ball_scene(), {});
  const PreparedScene b = prepare_scene(box_and_ball_scene(), {.num_threads = 4});
  EXPECT_GT(a.num_segments, 5);
  EXPECT_EQ(a.segment, b.segment);
  EXPECT_EQ(a.plane, b.plane);
}

TEST(PrepareScene, QuickPlanesDependNeitherOnThreadsNorOnWhoDownsampledTheScene) {
  VerifyOptions options{.clutter = {.rule = ContinuationClutter{}}, .planes = PlaneOptions{.spacing_m = 0.01}};
  const PreparedScene a = prepare_scene(box_and_ball_scene(), options);
  ASSERT_FALSE(a.planes.empty());
  options.num_threads = 4;
  const PreparedScene b = prepare_scene(box_and_ball_scene(), options);
  const PreparedScene thin = prepare_scene(voxel_downsample(box_and_ball_scene(), options.resolution_m), options);
  for (const PreparedScene& other : {b, thin}) {
    EXPECT_EQ(a.points, other.points);
    EXPECT_EQ(a.plane, other.plane);
    ASSERT_EQ(a.planes.size(), other.planes.size());
    for (std::size_t p = 0; p < a.planes.size(); ++p) {
      EXPECT_EQ(a.planes[p].normal, other.planes[p].normal);
      EXPECT_EQ(a.planes[p].offset, other.planes[p].offset);
    }
  }
}

TEST(CropToBalls, KeepsAllPointsNearAndNoneFar) {
  const PointCloud cloud = box_and_ball_scene();
  const std::vector<Ball> balls = {{{0.2F, 0.1F, 0.06F}, 0.15F}, {{-0.3F, -0.3F, 0}, 0.05F}};
  const PointCloud cropped = crop_to_balls(cloud, balls);
  const auto distance = [&](const Eigen::Vector3f& p) {
    float nearest = 10;
    for (const Ball& ball : balls) nearest = std::min(nearest, (p - ball.center).norm() - ball.radius_m);
    return nearest;
  };
  const auto count_near = [&](const PointCloud& c) {
    return std::count_if(c.points.begin(), c.points.end(), [&](const auto& p) { return distance(p) <= 0; });
  };
  EXPECT_GT(count_near(cropped), 1000);
  EXPECT_EQ(count_near(cropped), count_near(cloud));
  for (const Eigen::Vector3f& p : cropped.points) EXPECT_LT(distance(p), 0.35F);
  EXPECT_LT(cropped.size(), cloud.size() / 2);
  EXPECT_TRUE(crop_to_balls(cloud, {}).empty());
}

TEST(FindSmoothSegments, AgreesWithASlowTwin) {
  // Two sheets that meet at 90 degrees, a third apart, of several blocks of cells. The reference floods from every
  // point over all pairs.
  std::vector<Eigen::Vector3f> points;
  std::vector<Eigen::Vector3f> normals;
  for (int i = 0; i < 32; ++i)
    for (int j = 0; j < 32; ++j) {
      const float a = 0.005F * static_cast<float>(i);
      const float b = 0.005F * static_cast<float>(j);
      points.insert(points.end(), {{a, b, 0}, {0, b, a + 0.005F}, {a + 0.3F, b, 0}});
      normals.insert(normals.end(), {Eigen::Vector3f::UnitZ(), Eigen::Vector3f::UnitX(), Eigen::Vector3f::UnitZ()});
    }
  const SmoothSegmentsOptions options;
  const SmoothSegments found = find_smooth_segments(points, normals, options);
  EXPECT_EQ(found.num_segments, 3);
  std::vector<float> curvature(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    Eigen::Vector3f sum = Eigen::Vector3f::Zero();
    int count = 0;
    for (std::size_t j = 0; j < points.size(); ++j)
      if ((points[i] - points[j]).norm() <= options.max_distance_m) {
        sum += normals[j];
        ++count;
      }
    curvature[i] = 1 - sum.norm() / static_cast<float>(count);
  }
  int joined = 0;
  int edges = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (curvature[i] > options.max_curvature) ++edges;
    EXPECT_GE(found.segment[i], 0);
    for (std::size_t j = 0; j < i; ++j) {
      if ((points[i] - points[j]).norm() > options.max_distance_m) continue;
      if (curvature[i] > options.max_curvature || curvature[j] > options.max_curvature) continue;
      if (normals[i].dot(normals[j]) < 0.9F)
        EXPECT_NE(found.segment[i], found.segment[j]);
      else
        EXPECT_EQ(found.segment[i], found.segment[j]);
      ++joined;
    }
  }
  EXPECT_GT(joined, 1000);
  EXPECT_GT(edges, 20);
}

TEST(LocalScene, VisitsExactlyThePointsWithinTheRadius) {
  Rng rng(2);
  std::vector<Eigen::Vector3f> scene;
  for (int i = 0; i < 4000; ++i)
    scene.push_back({static_cast<float>(rng.uniform(-0.3, 0.3)), static_cast<float>(rng.uniform(-0.3, 0.3)),
                     static_cast<float>(rng.uniform(-0.3, 0.3))});
  const BlockGrid blocks(scene, 0.06);
  const std::vector<Eigen::Vector3f> around = {{-0.1F, 0, 0.05F}, {0.1F, 0.12F, -0.07F}};
  const LocalScene local(scene, blocks, around, 0.04F, 0.015F);
  long checked = 0;
  for (int k = 0; k < 300; ++k) {
    Eigen::Vector3f query;
    for (int axis = 0; axis < 3; ++axis)
      query[axis] = static_cast<float>(
          rng.uniform(std::min(around[0][axis], around[1][axis]), std::max(around[0][axis], around[1][axis])));
    const float radius = k % 2 == 0 ? 0.015F : 0.04F;
    std::vector<int> found;
    local.visit_within(query, radius, [&](std::size_t i, float) {
      found.push_back(local.scene_index(i));
      return true;
    });
    std::sort(found.begin(), found.end());
    std::vector<int> expected;
    for (std::size_t i = 0; i < scene.size(); ++i)
      if ((scene[i] - query).squaredNorm() <= radius * radius) expected.push_back(static_cast<int>(i));
    EXPECT_EQ(found, expected);
    checked += static_cast<long>(expected.size());
  }
  EXPECT_GT(checked, 500);
  EXPECT_EQ(LocalScene({}, BlockGrid(), {}, 0.04F, 0.015F).size(), 0U);
}

}  // namespace
}  // namespace resight
