// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "resight/geometry/triangle_mesh.hpp"

namespace resight::test {

/// The cube [-1, 1]^3 with shared corners. The bits of i are the signs of corner i.
inline TriangleMesh make_cube() {
  TriangleMesh cube;
  for (int i = 0; i < 8; ++i)
    cube.vertices.emplace_back((i & 1) != 0 ? 1.0F : -1.0F, (i & 2) != 0 ? 1.0F : -1.0F, (i & 4) != 0 ? 1.0F : -1.0F);
  const auto quad = [&](int a, int b, int c, int d) {
    cube.faces.push_back({a, b, c});
    cube.faces.push_back({a, c, d});
  };
  quad(0, 2, 3, 1);
  quad(4, 5, 7, 6);
  quad(0, 1, 5, 4);
  quad(2, 6, 7, 3);
  quad(0, 4, 6, 2);
  quad(1, 3, 7, 5);
  return cube;
}

}  // namespace resight::test
