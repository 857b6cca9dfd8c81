// SPDX-License-Identifier: Apache-2.0
#include "resight/geometry/mesh_sampling.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <set>

namespace resight {
namespace {

// A closed tube of `radius` and height 0.1 m around z. Facets face outwards.
TriangleMesh make_cylinder(float radius) {
  TriangleMesh mesh;
  constexpr int kSides = 64;
  for (int i = 0; i < kSides; ++i) {
    const double phi = 2 * std::numbers::pi * i / kSides;
    const auto x = static_cast<float>(radius * std::cos(phi));
    const auto y = static_cast<float>(radius * std::sin(phi));
    mesh.vertices.emplace_back(x, y, 0.0F);
    mesh.vertices.emplace_back(x, y, 0.1F);
  }
  mesh.vertices.emplace_back(0.0F, 0.0F, 0.0F);
  mesh.vertices.emplace_back(0.0F, 0.0F, 0.1F);
  for (int i = 0; i < kSides; ++i) {
    const int a = 2 * i;
    const int b = 2 * ((i + 1) % kSides);
    mesh.faces.push_back({a, b, b + 1});
    mesh.faces.push_back({a, b + 1, a + 1});
    mesh.faces.push_back({2 * kSides, b, a});
    mesh.faces.push_back({2 * kSides + 1, a + 1, b + 1});
  }
  return mesh;
}

// Of a square of 16 m2, a million points per m2 would be too many.
TEST(SampleSurface, TheNumberOfPointsIsBounded) {
  TriangleMesh square;
  square.vertices = {{0, 0, 0}, {4, 0, 0}, {4, 4, 0}, {0, 4, 0}};
  square.faces = {{0, 1, 2}, {0, 2, 3}};
  const PointCloud cloud = sample_surface(square, 1e6);
  EXPECT_LE(cloud.size(), 10'000'000U);
  EXPECT_GT(cloud.size(), 9'999'000U);
  EXPECT_LT((centroid(cloud.points) - Eigen::Vector3f(2, 2, 0)).norm(), 0.01F);
}

double mesh_area(const TriangleMesh& mesh) {
  double area = 0;
  for (const auto& f : mesh.faces) {
    const Eigen::Vector3d a = mesh.vertices[f[0]].cast<double>();
    area += 0.5 * (mesh.vertices[f[1]].cast<double>() - a).cross(mesh.vertices[f[2]].cast<double>() - a).norm();
  }
  return area;
}

Eigen::Vector3f cylinder_normal(const Eigen::Vector3f& p) {
  if (p.z() < 1e-5F) return {0, 0, -1};
  if (p.z() > 0.1F - 1e-5F) return {0, 0, 1};
  return Eigen::Vector3f(p.x(), p.y(), 0).normalized();
}

TEST(SampleSurface, IsEvenAndFacesOutwards) {
  const TriangleMesh mesh = make_cylinder(0.04F);
  const PointCloud cloud = sample_surface(mesh, 1e6);
  EXPECT_NEAR(static_cast<double>(cloud.size()), 1e6 * mesh_area(mesh), 1.0);
  int top = 0;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const bool is_cap = std::abs(cloud.normals[i].z()) > 0.99F;
    const Eigen::Vector3f& p = cloud.points[i];
    if (is_cap) {
      ASSERT_NEAR(p.z(), cloud.normals[i].z() > 0 ? 0.1F : 0.0F, 1e-6F);
    } else {
      ASSERT_GT(cloud.normals[i].dot(Eigen::Vector3f(p.x(), p.y(), 0).normalized()), 0.99F);
    }
    ASSERT_EQ(cloud.colors[i], (Rgb8{128, 128, 128}));
    top += cloud.normals[i].z() > 0.99F ? 1 : 0;
  }
  EXPECT_NEAR(top, 1e6 * std::numbers::pi * 0.04 * 0.04, 25);
}

// Each place of the surface has a sample nearby: the largest hole has about the size of the spacing.
TEST(SampleSurface, LeavesNoHoles) {
  TriangleMesh square;
  square.vertices = {{0, 0, 0}, {0.1F, 0, 0}, {0.1F, 0.1F, 0}, {0, 0.1F, 0}};
  square.faces = {{0, 1, 2}, {0, 2, 3}};
  const PointCloud cloud = sample_surface(square, 1e6);  // one sample per mm^2
  std::set<std::pair<int, int>> cells;
  for (const auto& p : cloud.points) cells.emplace(static_cast<int>(p.x() / 0.002F), static_cast<int>(p.y() / 0.002F));
  EXPECT_EQ(cells.size(), 2500U);
}

TEST(SampleSurface, SmallTrianglesGetTheirShare) {
  TriangleMesh mesh;  // 40 x 40 x 2 triangles of 0.5 mm^2 each, with 0.2 samples per triangle
  for (int y = 0; y <= 40; ++y)
    for (int x = 0; x <= 40; ++x)
      mesh.vertices.emplace_back(0.001F * static_cast<float>(x), 0.001F * static_cast<float>(y), 0.0F);
  for (int y = 0; y < 40; ++y)
    for (int x = 0; x < 40; ++x) {
      const int a = 41 * y + x;
      mesh.faces.push_back({a, a + 1, a + 42});
      mesh.faces.push_back({a, a + 42, a + 41});
    }
  const PointCloud cloud = sample_surface(mesh, 0.4e6);
  EXPECT_NEAR(static_cast<double>(cloud.size()), 640, 1);
}

TEST(SampleSurface, FlipsAMeshThatIsInsideOut) {
  TriangleMesh mesh = make_cylinder(0.03F);
  for (auto& f : mesh.faces) std::swap(f[1], f[2]);
  const PointCloud cloud = sample_surface(mesh, 1e5);
  ASSERT_GT(cloud.size(), 1000U);
  for (std::size_t i = 0; i < cloud.size(); ++i)
    ASSERT_GT(cloud.normals[i].dot(cylinder_normal(cloud.points[i])), 0.99F);
}

TEST(SampleSurface, UsesSmoothNormalsWhateverTheirSign) {
  TriangleMesh mesh = make_cylinder(0.03F);
  for (const auto& v : mesh.vertices)
    mesh.normals.push_back(-Eigen::Vector3f(v - Eigen::Vector3f(0, 0, 0.05F)).normalized());
  for (const auto& [point, normal] : [&] {
         const PointCloud cloud = sample_surface(mesh, 1e5);
         std::vector<std::pair<Eigen::Vector3f, Eigen::Vector3f>> pairs;
         for (std::size_t i = 0; i < cloud.size(); ++i) pairs.emplace_back(cloud.points[i], cloud.normals[i]);
         return pairs;
       }()) {
    ASSERT_NEAR(normal.norm(), 1, 1e-5);
    ASSERT_GT(normal.dot(point - Eigen::Vector3f(0, 0, 0.05F)), 0);
  }
}

TEST(SampleSurface, SkipsFacesWithoutArea) {
  TriangleMesh mesh = make_cylinder(0.03F);
  const std::size_t whole = sample_surface(mesh, 1e5).size();
  for (int i = 0; i < 50; ++i) mesh.faces.insert(mesh.faces.begin(), {0, 0, 1});
  EXPECT_EQ(sample_surface(mesh, 1e5).size(), whole);
  TriangleMesh flat;
  flat.vertices.assign(3, Eigen::Vector3f(1, 1, 1));
  flat.faces = {{0, 1, 2}};
  EXPECT_TRUE(sample_surface(flat, 1e6).empty());
}

}  // namespace
}  // namespace resight
