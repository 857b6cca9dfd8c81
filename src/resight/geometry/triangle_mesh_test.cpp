// SPDX-License-Identifier: Apache-2.0
#include "resight/geometry/triangle_mesh.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "resight/core/random.hpp"
#include "resight/geometry/cube_mesh_test_util.hpp"

namespace resight {
namespace {

using test::make_cube;

TriangleMesh make_textured_square(Image<Rgb8> texture) {
  TriangleMesh square;
  square.vertices = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  square.uvs = {{0, 1}, {1, 1}, {1, 0}, {0, 0}};  // v points down, as image rows do
  square.faces = {{0, 1, 2}, {0, 2, 3}};
  square.texture = std::move(texture);
  return square;
}

TEST(ComputeVertexNormals, PointOutOfACube) {
  TriangleMesh cube = make_cube();
  compute_vertex_normals(cube);
  ASSERT_EQ(cube.normals.size(), 8U);
  for (std::size_t i = 0; i < 8; ++i) {
    EXPECT_NEAR(cube.normals[i].norm(), 1, 1e-5);
    for (int axis = 0; axis < 3; ++axis) EXPECT_GT(cube.normals[i][axis] * cube.vertices[i][axis], 0.3F);
  }
}

TEST(ComputeVertexNormals, AreWeightedByAreaAndAlwaysUnit) {
  TriangleMesh mesh;
  mesh.vertices = {{0, 0, 0}, {10, 0, 0}, {0, 10, 0}, {0, 0.1F, 0}, {0, 0, 0.1F}, {5, 5, 5}};
  mesh.faces = {{0, 1, 2}, {0, 3, 4}};  // a large face along z and a tiny one along x; no face uses vertex 5
  compute_vertex_normals(mesh);
  EXPECT_GT(mesh.normals[0].z(), 0.999F);
  EXPECT_NEAR(mesh.normals[3].x(), 1, 1e-5);
  EXPECT_NEAR(mesh.normals[5].norm(), 1, 1e-5);
}

TEST(TriangleMesh, AppendShiftsFaces) {
  TriangleMesh two = make_cube();
  compute_vertex_normals(two);
  const TriangleMesh one = two;
  two.append(one);
  EXPECT_EQ(two.vertices.size(), 16U);
  EXPECT_EQ(two.normals.size(), 16U);
  ASSERT_EQ(two.faces.size(), 24U);
  for (std::size_t f = 0; f < 12; ++f)
    for (std::size_t k = 0; k < 3; ++k) EXPECT_EQ(two.faces[f + 12].at(k), one.faces[f].at(k) + 8);
  two.append(two);
  EXPECT_EQ(two.faces.size(), 48U);
  TriangleMesh bare = make_cube();
  EXPECT_THROW(bare.append(one), std::invalid_argument);
  TriangleMesh from_nothing;
  from_nothing.append(one);
  EXPECT_EQ(from_nothing.normals.size(), 8U);
}

TEST(TriangleMesh, AppendRefusesTwoTextures) {
  TriangleMesh square = make_textured_square(Image<Rgb8>(1, 1));
  EXPECT_THROW(square.append(make_textured_square(Image<Rgb8>(1, 1))), std::invalid_argument);
}

TEST(SurfaceColor, InterpolatesVertexColours) {
  TriangleMesh mesh;
  mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  mesh.faces = {{0, 1, 2}};
  EXPECT_EQ(surface_color(mesh, 0, 0.3F, 0.3F), (Rgb8{128, 128, 128}));
  mesh.colors = {{200, 0, 0}, {0, 100, 0}, {0, 0, 50}};
  EXPECT_EQ(surface_color(mesh, 0, 1, 0), (Rgb8{200, 0, 0}));
  EXPECT_EQ(surface_color(mesh, 0, 0, 1), (Rgb8{0, 100, 0}));
  EXPECT_EQ(surface_color(mesh, 0, 0, 0), (Rgb8{0, 0, 50}));
  EXPECT_EQ(surface_color(mesh, 0, 0.5F, 0.25F), (Rgb8{100, 25, 13}));
}

TEST(SurfaceColor, TextureIsBilinearWithItsOriginTopLeft) {
  // The left column is black, the right one red. The top row also has green 200.
  Image<Rgb8> texture(2, 2);
  texture(0, 0) = {0, 200, 0};
  texture(1, 0) = {100, 200, 0};
  texture(1, 1) = {100, 0, 0};
  const TriangleMesh square = make_textured_square(texture);
  // Face 0 contains (x, y) with x >= y: barycentric (1 - x, x - y, y).
  const auto at = [&](float x, float y) { return surface_color(square, 0, 1 - x, x - y); };
  EXPECT_EQ(at(0.25F, 0.25F), (Rgb8{0, 0, 0}));      // centre of the bottom left texel
  EXPECT_EQ(at(0.75F, 0.25F), (Rgb8{100, 0, 0}));    // bottom right
  EXPECT_EQ(at(0.75F, 0.75F), (Rgb8{100, 200, 0}));  // top right
  EXPECT_EQ(at(0.5F, 0.25F), (Rgb8{50, 0, 0}));
  EXPECT_EQ(at(0.75F, 0.5F), (Rgb8{100, 100, 0}));
  EXPECT_EQ(at(1.0F, 0.0F), (Rgb8{100, 0, 0}));  // u = 1 is the right border, not the left one
  EXPECT_EQ(at(1.0F, 1.0F), (Rgb8{100, 200, 0}));
}

TEST(SurfaceColor, TextureWinsAndRepeatsOutsideOfTheUnitSquare) {
  Image<Rgb8> texture(4, 1);
  for (int u = 0; u < 4; ++u) texture(u, 0) = {static_cast<std::uint8_t>(10 * u), 0, 0};
  TriangleMesh square = make_textured_square(texture);
  square.colors.assign(4, Rgb8{255, 255, 255});
  const auto at_u = [&](float u) {
    for (auto& uv : square.uvs) uv = {u, 0.5F};
    return surface_color(square, 0, 0.3F, 0.3F).r;
  };
  EXPECT_EQ(at_u(0.625F), 20);
  EXPECT_EQ(at_u(3.625F), 20);
  EXPECT_EQ(at_u(-0.375F), 20);
}

TEST(UsedVertices, AreThoseOfFacesWithArea) {
  TriangleMesh mesh = make_cube();
  mesh.vertices.insert(mesh.vertices.end(), {{9, 9, 9}, {3, 1, 1}, {1.1F, 1.1F, 1.1F}, {5.3F, 5.3F, 5.3F}});
  mesh.faces.push_back({7, 7, 9});    // a line
  mesh.faces.push_back({9, 9, 9});    // a point
  mesh.faces.push_back({7, 10, 11});  // a line with rounded corners
  EXPECT_EQ(used_vertices(mesh), make_cube().vertices);
  mesh.faces.push_back({0, 7, 8});  // also a line: through the middle of the cube
  EXPECT_EQ(used_vertices(mesh), make_cube().vertices);
  mesh.faces.push_back({3, 7, 9});
  EXPECT_EQ(used_vertices(mesh).size(), 9U);
  EXPECT_TRUE(used_vertices({}).empty());
}

float brute_force_diameter(const std::vector<Eigen::Vector3f>& points) {
  float best = 0;
  for (const auto& a : points)
    for (const auto& b : points) best = std::max(best, (a - b).norm());
  return best;
}

TEST(Diameter, IsExactForFewPoints) {
  EXPECT_EQ(diameter({}), 0.0F);
  const std::vector<Eigen::Vector3f> one{{1, 2, 3}};
  EXPECT_EQ(diameter(one), 0.0F);
  EXPECT_NEAR(diameter(make_cube().vertices), 2 * std::sqrt(3.0F), 1e-5);
  Rng rng(1);
  std::vector<Eigen::Vector3f> points;
  for (int i = 0; i < 500; ++i)
    points.push_back(
        {static_cast<float>(rng.normal()), static_cast<float>(rng.normal()), static_cast<float>(rng.normal())});
  EXPECT_NEAR(diameter(points), brute_force_diameter(points), 1e-5);
}

// 512 directions are 4.5 deg apart. The cosine of half that angle limits the error on these shapes to under 0.1 %.
TEST(Diameter, OfManyPointsIsNearlyExactAndNeverTooLarge) {
  Rng rng(2);
  for (int shape = 0; shape < 6; ++shape) {
    const Eigen::Vector3f half{static_cast<float>(rng.uniform(0.02, 0.2)), static_cast<float>(rng.uniform(0.02, 0.2)),
                               static_cast<float>(rng.uniform(0.02, 0.2))};
    std::vector<Eigen::Vector3f> points;
    for (int i = 0; i < 2500; ++i) {
      const Eigen::Vector3f p{static_cast<float>(rng.uniform(-1, 1)), static_cast<float>(rng.uniform(-1, 1)),
                              static_cast<float>(rng.uniform(-1, 1))};
      points.emplace_back(half.cwiseProduct(shape % 2 == 0 ? p : Eigen::Vector3f(p.normalized())));
    }
    const float exact = brute_force_diameter(points);
    EXPECT_LE(diameter(points), exact * 1.00001F);
    EXPECT_GE(diameter(points), exact * 0.999F);
  }
}

}  // namespace
}  // namespace resight
