// SPDX-License-Identifier: Apache-2.0
#include "resight/geometry/corner_normals.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "resight/geometry/cube_mesh_test_util.hpp"

namespace resight {
namespace {

using test::make_cube;

// An icosahedron whose faces are divided into four, on the unit sphere.
TriangleMesh make_sphere_of_80_faces() {
  const float g = 1.618034F;
  TriangleMesh sphere;
  sphere.vertices = {{-1, g, 0},  {1, g, 0},  {-1, -g, 0}, {1, -g, 0}, {0, -1, g},  {0, 1, g},
                     {0, -1, -g}, {0, 1, -g}, {g, 0, -1},  {g, 0, 1},  {-g, 0, -1}, {-g, 0, 1}};
  const std::vector<std::array<int, 3>> icosahedron{{0, 11, 5}, {0, 5, 1},  {0, 1, 7},   {0, 7, 10}, {0, 10, 11},
                                                    {1, 5, 9},  {5, 11, 4}, {11, 10, 2}, {10, 7, 6}, {7, 1, 8},
                                                    {3, 9, 4},  {3, 4, 2},  {3, 2, 6},   {3, 6, 8},  {3, 8, 9},
                                                    {4, 9, 5},  {2, 4, 11}, {6, 2, 10},  {8, 6, 7},  {9, 8, 1}};
  const auto middle_of = [&](int a, int b) {
    const Eigen::Vector3f middle = 0.5F * (sphere.vertices[a] + sphere.vertices[b]);
    const auto found = std::ranges::find(sphere.vertices, middle);
    if (found != sphere.vertices.end()) return static_cast<int>(found - sphere.vertices.begin());
    sphere.vertices.push_back(middle);
    return static_cast<int>(sphere.vertices.size()) - 1;
  };
  for (const auto& [a, b, c] : icosahedron) {
    const int ab = middle_of(a, b);
    const int bc = middle_of(b, c);
    const int ca = middle_of(c, a);
    sphere.faces.insert(sphere.faces.end(), {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
  }
  for (Eigen::Vector3f& v : sphere.vertices) v.normalize();
  return sphere;
}

void expect_flat(const TriangleMesh& cube, float outward) {
  for (int face = 0; face < 12; ++face) {
    const std::array<Eigen::Vector3f, 3> n = corner_normals(cube, face);
    EXPECT_EQ(n[0], n[1]);
    EXPECT_EQ(n[0], n[2]);
    EXPECT_NEAR(n[0].lpNorm<Eigen::Infinity>(), 1, 1e-5);
    for (const int v : cube.faces[face]) EXPECT_NEAR(cube.vertices[v].dot(n[0]), outward, 1e-5);
  }
}

void expect_shared(const TriangleMesh& mesh) {
  for (std::size_t face = 0; face < mesh.faces.size(); ++face) {
    const std::array<Eigen::Vector3f, 3> n = corner_normals(mesh, static_cast<int>(face));
    for (std::size_t k = 0; k < 3; ++k) EXPECT_EQ(n[k], mesh.normals[mesh.faces[face][k]]);
  }
}

TEST(CornerNormals, FacesOfACubeWithSharedCornersAreFlat) {
  TriangleMesh cube = make_cube();
  compute_vertex_normals(cube);
  expect_flat(cube, 1);
  for (Eigen::Vector3f& n : cube.normals) n = -n;  // As a file may have them.
  expect_flat(cube, -1);
}

TEST(CornerNormals, CoarseSpheresAndSmallFacesStaySmooth) {
  TriangleMesh sphere = make_sphere_of_80_faces();
  ASSERT_EQ(sphere.vertices.size(), 42U);
  ASSERT_EQ(sphere.faces.size(), 80U);
  compute_vertex_normals(sphere);
  expect_shared(sphere);
  TriangleMesh small = make_cube();
  for (Eigen::Vector3f& v : small.vertices) v *= 0.001F;
  compute_vertex_normals(small);
  expect_shared(small);
}

}  // namespace
}  // namespace resight
