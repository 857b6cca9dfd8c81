// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "resight/simulation/procedural_objects.hpp"

namespace resight {

/// Names of the objects that a seed makes. Shapes, sizes, colours, prints and materials follow the seed, and so do the
/// names ("box_kavu"), so that objects of two seeds are not mistaken for each other.
struct SeededObjectNames {
  /// For a library: printed boxes, flat packages, cartons, books, cans, bottles, cups, toys. Among them are two pairs
  /// of twins (same shape, other print), untextured and symmetric objects, a thin, a small, and a clear one, from which
  /// the depth camera gets almost no return.
  std::vector<std::string> known;
  /// For no library. The first three have the shape or the print of a known object.
  std::vector<std::string> unknown;
};
[[nodiscard]] SeededObjectNames seeded_object_names(std::uint64_t seed);

/// Draws one object of a seed with the same bytes each time. Fails for an unknown name.
[[nodiscard]] Result<ProceduralObject> make_seeded_object(std::uint64_t seed, std::string_view name);

}  // namespace resight
