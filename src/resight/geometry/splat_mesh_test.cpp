// SPDX-License-Identifier: Apache-2.0
#include "resight/geometry/splat_mesh.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <stdexcept>

#include "resight/core/random.hpp"

namespace resight {
namespace {

constexpr float kSpacing_m = 0.004F;

// A square in the plane z = 0. Red increases along x, green along y.
PointCloud make_plane(int points_per_side) {
  PointCloud plane;
  for (int y = 0; y < points_per_side; ++y)
    for (int x = 0; x < points_per_side; ++x) {
      plane.points.emplace_back(kSpacing_m * static_cast<float>(x), kSpacing_m * static_cast<float>(y), 0.0F);
      plane.normals.emplace_back(0.0F, 0.0F, 1.0F);
      plane.colors.push_back({static_cast<std::uint8_t>(4 * x), static_cast<std::uint8_t>(4 * y), 77});
    }
  return plane;
}

bool is_inside(const TriangleMesh& mesh, const std::array<int, 3>& f, const Eigen::Vector2f& p) {
  const auto side = [&](int a, int b) {
    const Eigen::Vector2f d = (mesh.vertices[b] - mesh.vertices[a]).head<2>();
    const Eigen::Vector2f to = p - mesh.vertices[a].head<2>();
    return d.x() * to.y() - d.y() * to.x();
  };
  return side(f[0], f[1]) >= 0 && side(f[1], f[2]) >= 0 && side(f[2], f[0]) >= 0;
}

TEST(SplatMesh, CoversAPlaneWithoutGapsAndFacesItsNormal) {
  const TriangleMesh mesh = make_splat_mesh(make_plane(20));
  for (const auto& f : mesh.faces) {
    const Eigen::Vector3f cross =
        (mesh.vertices[f[1]] - mesh.vertices[f[0]]).cross(mesh.vertices[f[2]] - mesh.vertices[f[0]]);
    ASSERT_GT(cross.z(), 0);
    ASSERT_LT(cross.head<2>().norm(), 1e-6F * cross.z());
  }
  Rng rng(1);
  for (int i = 0; i < 500; ++i) {
    const Eigen::Vector2f p{static_cast<float>(rng.uniform(0, 19 * kSpacing_m)),
                            static_cast<float>(rng.uniform(0, 19 * kSpacing_m))};
    EXPECT_TRUE(std::ranges::any_of(mesh.faces, [&](const auto& f) { return is_inside(mesh, f, p); })) << p.transpose();
  }
}

// The result must not depend on which of two overlapping discs is hit: colour and normal are fields over space.
TEST(SplatMesh, ColoursAndNormalsFollowTheSurface) {
  const TriangleMesh mesh = make_splat_mesh(make_plane(20));
  int num_inner = 0;
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    EXPECT_LT((mesh.normals[i] - Eigen::Vector3f::UnitZ()).norm(), 1e-5F);
    EXPECT_EQ(mesh.colors[i].b, 77);
    const Eigen::Vector2f cells = mesh.vertices[i].head<2>() / kSpacing_m;
    if (cells.minCoeff() < 3 || cells.maxCoeff() > 16) continue;  // beside the border, means are biased inwards
    EXPECT_NEAR(mesh.colors[i].r, 4 * cells.x(), 1.5);
    EXPECT_NEAR(mesh.colors[i].g, 4 * cells.y(), 1.5);
    ++num_inner;
  }
  EXPECT_GT(num_inner, 500);
}

TEST(SplatMesh, TheOtherSideOfAThinWallHasNoPartInIt) {
  PointCloud wall = make_plane(12);
  const std::size_t num_front = wall.size();
  PointCloud back = make_plane(12);
  for (std::size_t i = 0; i < back.size(); ++i) {
    back.points[i].z() -= 0.1F * kSpacing_m;
    back.normals[i] = {0, 0, -1};
    back.colors[i] = {200, 200, 200};
  }
  wall.append(back);
  const TriangleMesh mesh = make_splat_mesh(wall);
  ASSERT_GE(mesh.vertices.size(), wall.size());
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    const bool is_front = i < mesh.vertices.size() / wall.size() * num_front;
    EXPECT_EQ(mesh.colors[i].b, is_front ? 77 : 200);
    EXPECT_EQ(mesh.normals[i].z() > 0, is_front);
  }
}

TEST(SplatMesh, ALonePointStaysSmallAndThreadsDoNotMatter) {
  PointCloud plane = make_plane(12);
  plane.points.emplace_back(0.0F, 0.0F, 1.0F);
  plane.normals.emplace_back(0.0F, 0.0F, 1.0F);
  plane.colors.push_back({0, 0, 0});
  const TriangleMesh mesh = make_splat_mesh(plane, {.num_threads = 1});
  for (const Eigen::Vector3f& v : mesh.vertices) ASSERT_TRUE(v.z() < 0.5F || v.head<2>().norm() < 5 * kSpacing_m);
  EXPECT_EQ(mesh.colors, make_splat_mesh(plane, {.num_threads = 2}).colors);
}

TEST(SplatMesh, RefusesWhatItCannotDraw) {
  PointCloud plane = make_plane(12);
  EXPECT_THROW((void)make_splat_mesh(plane, {.num_neighbors = 2}), std::invalid_argument);
  plane.normals.clear();
  EXPECT_THROW((void)make_splat_mesh(plane), std::invalid_argument);
  PointCloud same = make_plane(12);
  for (Eigen::Vector3f& p : same.points) p.setZero();
  EXPECT_THROW((void)make_splat_mesh(same), std::invalid_argument);
}

}  // namespace
}  // namespace resight
