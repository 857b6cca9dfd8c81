// SPDX-License-Identifier: Apache-2.0
#include "resight/modelling/mesh_quality.hpp"

#include <gtest/gtest.h>

namespace resight {
namespace {

// n x n squares with sides of `cell_m`, without those for which `is_hole` is true.
template <typename IsHole>
TriangleMesh make_grid(int n, float cell_m, IsHole is_hole) {
  TriangleMesh mesh;
  for (int y = 0; y <= n; ++y)
    for (int x = 0; x <= n; ++x)
      mesh.vertices.push_back({cell_m * static_cast<float>(x), cell_m * static_cast<float>(y), 0});
  for (int y = 0; y < n; ++y)
    for (int x = 0; x < n; ++x) {
      if (is_hole(x, y)) continue;
      const int a = y * (n + 1) + x;
      mesh.faces.push_back({a, a + 1, a + n + 2});
      mesh.faces.push_back({a, a + n + 2, a + n + 1});
    }
  return mesh;
}

TEST(MeshHoles, AreFoundAndMeasured) {
  // A sheet of 10 x 10 cm with one hole of 2 x 2 cm and one of 1 mm^2. The rim of the sheet counts as a hole too.
  const TriangleMesh mesh = make_grid(
      100, 0.001F, [](int x, int y) { return (x >= 20 && x < 40 && y >= 50 && y < 70) || (x == 80 && y == 80); });
  const MeshHoles holes = measure_holes(mesh);
  EXPECT_EQ(holes.count, 2);
  EXPECT_NEAR(holes.boundary_length_m, 0.4 + 0.08 + 0.004, 1e-4);
  EXPECT_NEAR(holes.area_sq_m, 0.01 + 0.0004 + 1e-6, 1e-5);
  EXPECT_NEAR(surface_area(mesh), 0.01 - 0.0004 - 1e-6, 1e-6);
  EXPECT_NEAR(holes.open_share, 0.0104 / 0.02, 1e-3);
}

TEST(MeshHoles, AClosedMeshHasNone) {
  TriangleMesh mesh;
  mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  mesh.faces = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}};
  EXPECT_EQ(measure_holes(mesh).boundary_length_m, 0);
  EXPECT_EQ(measure_holes(mesh).open_share, 0);
  EXPECT_EQ(measure_holes(TriangleMesh{}).open_share, 0);
}

TEST(KeepLargeParts, DropsSmallOnesWithTheirVertices) {
  TriangleMesh mesh = make_grid(20, 0.001F, [](int x, int) { return x == 15; });  // Components of 15 and 4 columns.
  mesh.colors.resize(mesh.vertices.size());
  for (std::size_t i = 0; i < mesh.colors.size(); ++i) mesh.colors[i].r = static_cast<std::uint8_t>(i % 21);
  const TriangleMesh all = keep_large_parts(mesh, 0.2);
  EXPECT_EQ(all.faces.size(), 2U * 19 * 20);
  const TriangleMesh large = keep_large_parts(mesh, 0.5);
  EXPECT_EQ(large.faces.size(), 2U * 15 * 20);
  ASSERT_EQ(large.vertices.size(), 16U * 21);
  for (std::size_t i = 0; i < large.vertices.size(); ++i)
    EXPECT_NEAR(large.vertices[i].x(), 0.001F * large.colors[i].r, 1e-6);
  EXPECT_TRUE(keep_large_parts(TriangleMesh{}, 0.5).empty());
}

}  // namespace
}  // namespace resight
