// SPDX-License-Identifier: Apache-2.0
#include "resight/modelling/internal/align_shapes.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "resight/simulation/procedural_objects.hpp"
#include "resight/simulation/surface_sampling.hpp"

namespace resight {
namespace {

// The points of a generated object between two heights, in their own frame.
TriangleMesh part_of(const std::string& object, double from_m, double to_m, const Rigid3& part_from_object) {
  const PointCloud surface = sample_visible_surface(make_procedural_object(object)->mesh, 0.003);
  TriangleMesh part;
  const Rigid3f pose(part_from_object);
  for (std::size_t i = 0; i < surface.size(); ++i) {
    if (surface.points[i].z() < from_m || surface.points[i].z() > to_m) continue;
    part.vertices.push_back(pose * surface.points[i]);
    part.normals.push_back(pose.rotation * surface.normals[i]);
  }
  return part;
}

TEST(AlignShapes, JoinsPartsOfAnUntexturedObject) {
  const TriangleMesh upper = part_of("duck", 0.02, 1, Rigid3::identity());
  const Rigid3 moved{Rigid3::from_axis_angle({1, 0.2, 0.1}, 2.9).rotation, {0.05, -0.03, 0.1}};
  const TriangleMesh lower = part_of("duck", -1, 0.08, moved);
  const std::vector<ShapeFit> fits = align_shapes(upper, lower, {.num_samples = 200, .num_threads = 2});
  ASSERT_FALSE(fits.empty());
  const bool found = std::ranges::any_of(fits, [&](const ShapeFit& f) {
    return rotation_angle_rad(f.fixed_from_moving.rotation, moved.inverse().rotation) < 0.05 &&
           (f.fixed_from_moving * moved * Eigen::Vector3d(0, 0, 0.05) - Eigen::Vector3d(0, 0, 0.05)).norm() < 0.003;
  });
  EXPECT_TRUE(found);
  for (std::size_t k = 1; k < fits.size(); ++k) EXPECT_LE(fits[k].agreement, fits[k - 1].agreement);
}

TEST(AlignShapes, AnyNumberOfThreads) {
  const TriangleMesh a = part_of("toy_car", -1, 1, Rigid3::identity());
  const TriangleMesh b = part_of("toy_car", -1, 1, {Rigid3::from_axis_angle({0, 1, 1}, 1).rotation, {0.1, 0, 0}});
  AlignShapesOptions options{.num_directions = 20, .num_rotations = 6, .num_samples = 100};
  const std::vector<ShapeFit> one = align_shapes(a, b, options);
  options.num_threads = 3;
  const std::vector<ShapeFit> three = align_shapes(a, b, options);
  ASSERT_EQ(one.size(), three.size());
  for (std::size_t k = 0; k < one.size(); ++k)
    EXPECT_EQ(one[k].fixed_from_moving.matrix(), three[k].fixed_from_moving.matrix());
  EXPECT_GT(one[0].agreement, 0.9);
}

TEST(AlignShapes, NothingFitsNothing) {
  const TriangleMesh some = part_of("toy_car", -1, 1, Rigid3::identity());
  EXPECT_TRUE(align_shapes({}, some, {}).empty());
  EXPECT_TRUE(align_shapes(some, {}, {}).empty());
}

}  // namespace
}  // namespace resight
