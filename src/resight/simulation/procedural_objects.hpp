// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <string_view>
#include <vector>

#include "resight/core/result.hpp"
#include "resight/geometry/symmetry.hpp"
#include "resight/geometry/triangle_mesh.hpp"

namespace resight {

/// A household object drawn by a program: metres, origin at the bottom centre, +z up, front to -y.
struct ProceduralObject {
  std::string name;
  TriangleMesh mesh;
  ObjectSymmetries symmetries;
  std::string kind;  ///< "textured", "plain" (no print) or "twin" (as another one but for its print).
};

/// Names of all objects, in a fixed order: boxes, cans, bottles, crockery, books, toys and others. Twins
/// (cereal_red / cereal_blue, soup_tomato / soup_pea) have the same shape; plain ones have no texture, and symmetries.
[[nodiscard]] const std::vector<std::string>& procedural_object_names();

/// Draws one object: the same bytes each time. An error for an unknown name, which lists the known ones.
[[nodiscard]] Result<ProceduralObject> make_procedural_object(std::string_view name);

/// All objects, in the order of their names.
[[nodiscard]] std::vector<ProceduralObject> procedural_objects(int num_threads = 1);

}  // namespace resight
