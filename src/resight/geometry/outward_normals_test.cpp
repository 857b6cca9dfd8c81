// SPDX-License-Identifier: Apache-2.0
#include "resight/geometry/outward_normals.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "resight/core/random.hpp"

namespace resight {
namespace {

struct Surface {
  std::vector<Eigen::Vector3f> points;
  std::vector<Eigen::Vector3f> normals;
};

void add(Surface& surface, const Eigen::Vector3d& p, const Eigen::Vector3d& n) {
  surface.points.push_back(p.cast<float>());
  surface.normals.push_back(n.normalized().cast<float>());
}

Surface make_sphere(int count, double radius_m) {
  Surface sphere;
  Rng rng(1);
  for (int i = 0; i < count; ++i) {
    const Eigen::Vector3d n = Eigen::Vector3d{rng.normal(), rng.normal(), rng.normal()}.normalized();
    add(sphere, Eigen::Vector3d(0.3, 0, 1) + radius_m * n, n);
  }
  return sphere;
}

Surface make_box(double spacing_m) {
  Surface box;
  const Eigen::Vector3d half(0.06, 0.04, 0.08);
  for (int axis = 0; axis < 3; ++axis)
    for (const double side : {-1.0, 1.0}) {
      const int a = (axis + 1) % 3;
      const int b = (axis + 2) % 3;
      for (double x = -half[a]; x <= half[a] + 1e-9; x += spacing_m)
        for (double y = -half[b]; y <= half[b] + 1e-9; y += spacing_m) {
          Eigen::Vector3d p;
          p[axis] = side * half[axis];
          p[a] = x;
          p[b] = y;
          add(box, p, side * Eigen::Vector3d::Unit(axis));
        }
    }
  return box;
}

// An open cup. Its inner wall lies 6 mm behind the outer one and faces the axis.
Surface make_cup(double spacing_m) {
  Surface cup;
  for (const double radius : {0.040, 0.034}) {
    const double side = radius > 0.037 ? 1.0 : -1.0;
    const int steps = static_cast<int>(2 * std::numbers::pi * radius / spacing_m);
    for (double z = 0; z < 0.1; z += spacing_m)
      for (int i = 0; i < steps; ++i) {
        const double angle = 2 * std::numbers::pi * i / steps;
        const Eigen::Vector3d n(std::cos(angle), std::sin(angle), 0);
        add(cup, radius * n + z * Eigen::Vector3d::UnitZ(), side * n);
      }
  }
  for (double radius = 0.034; radius <= 0.040; radius += spacing_m)  // the rim joins the walls
    for (double angle = 0; angle < 2 * std::numbers::pi; angle += spacing_m / radius)
      add(cup, {radius * std::cos(angle), radius * std::sin(angle), 0.1}, {0, 0, 1});
  return cup;
}

// Share of normals within `max_deg` of the truth, sign included.
double agreement(const Surface& surface, const std::vector<Eigen::Vector3f>& normals, double max_deg) {
  int count = 0;
  for (std::size_t i = 0; i < normals.size(); ++i)
    count += normals[i].dot(surface.normals[i]) > std::cos(max_deg * std::numbers::pi / 180) ? 1 : 0;
  return count / static_cast<double>(normals.size());
}

TEST(OutwardNormals, OfASphereBoxAndCup) {
  const Surface sphere = make_sphere(3000, 0.05);
  EXPECT_GT(agreement(sphere, estimate_outward_normals(sphere.points), 20), 0.99);
  const Surface box = make_box(0.003);
  const auto box_normals = estimate_outward_normals(box.points);
  EXPECT_EQ(agreement(box, box_normals, 89), 1.0);
  EXPECT_GT(agreement(box, box_normals, 5), 0.8);  // the remaining points lie at edges
  const Surface cup = make_cup(0.002);
  EXPECT_GT(agreement(cup, estimate_outward_normals(cup.points), 30), 0.95);
}

TEST(OutwardNormals, NoiseDoesNotFlipThem) {
  Surface box = make_box(0.002);
  Rng rng(2);
  for (Eigen::Vector3f& p : box.points)
    p += 0.0004F * Eigen::Vector3d{rng.normal(), rng.normal(), rng.normal()}.cast<float>();
  EXPECT_GT(agreement(box, estimate_outward_normals(box.points), 60), 0.97);
}

TEST(OutwardNormals, EachOfTwoPartsFacesOutwards) {
  Surface two = make_sphere(1000, 0.02);
  const Surface box = make_box(0.004);
  two.points.insert(two.points.end(), box.points.begin(), box.points.end());
  two.normals.insert(two.normals.end(), box.normals.begin(), box.normals.end());
  EXPECT_GT(agreement(two, estimate_outward_normals(two.points), 80), 0.99);
}

TEST(OutwardNormals, SameBitsOnAnyNumberOfThreads) {
  const Surface sphere = make_sphere(2000, 0.05);
  EXPECT_EQ(estimate_outward_normals(sphere.points, {.num_threads = 1}),
            estimate_outward_normals(sphere.points, {.num_threads = 3}));
}

TEST(OutwardNormals, FewPointsAndBadOptions) {
  EXPECT_TRUE(estimate_outward_normals({}).empty());
  const std::vector<Eigen::Vector3f> two{{0, 0, 0}, {1, 0, 0}};
  for (const Eigen::Vector3f& n : estimate_outward_normals(two)) EXPECT_NEAR(n.norm(), 1, 1e-5);
  const std::vector<Eigen::Vector3f> same(30, Eigen::Vector3f(1, 2, 3));
  for (const Eigen::Vector3f& n : estimate_outward_normals(same)) EXPECT_NEAR(n.norm(), 1, 1e-5);
  EXPECT_THROW((void)estimate_outward_normals(two, {.num_neighbors = 2}), std::invalid_argument);
}

TEST(TurnOutwards, FlipsNormalsThatPointInwards) {
  Surface cup = make_cup(0.004);
  std::vector<Eigen::Vector3f> normals = cup.normals;
  EXPECT_FALSE(turn_outwards(cup.points, normals));
  for (Eigen::Vector3f& n : normals) n = -n;
  EXPECT_TRUE(turn_outwards(cup.points, normals));
  EXPECT_EQ(normals, cup.normals);
}

}  // namespace
}  // namespace resight
