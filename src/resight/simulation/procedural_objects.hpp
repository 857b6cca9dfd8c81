// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <string_view>
#include <vector>

#include "resight/core/result.hpp"
#include "resight/geometry/symmetry.hpp"
#include "resight/geometry/triangle_mesh.hpp"
#include "resight/rendering/surface_material.hpp"

namespace resight {

/// A household object drawn by a program. Metres; origin at the bottom centre, +z up, front at -y.
struct ProceduralObject {
  std::string name;
  TriangleMesh mesh;
  ObjectSymmetries symmetries;
  std::string kind;  ///< "textured", "plain" (untextured) or "twin" (differs from another object only in its texture).
  SurfaceMaterial material = {};
};

/// Names of all objects in a fixed order: boxes, cans, bottles, crockery, books, toys and others. Twins (cereal_red /
/// cereal_blue, soup_tomato / soup_pea) have the same shape. Objects of kind "plain" have no texture, but symmetries.
[[nodiscard]] const std::vector<std::string>& procedural_object_names();

/// Draws one object with the same bytes each time. The error for an unknown name lists the known names.
[[nodiscard]] Result<ProceduralObject> make_procedural_object(std::string_view name);

/// Draws all objects in the order of their names.
[[nodiscard]] std::vector<ProceduralObject> procedural_objects(int num_threads = 1);

}  // namespace resight
