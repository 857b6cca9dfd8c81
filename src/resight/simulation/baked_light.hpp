// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>

#include "resight/simulation/procedural_objects.hpp"

namespace resight {

/// The mesh as a scanner delivers it: its texture (or vertex colours) contains the light of the place where it was
/// scanned, with the side towards a lamp brighter, the lower parts darker, and highlights where the material is glossy.
/// `seed` places the lamp. The scene's own light comes on top when such a model is rendered, as with real scans.
[[nodiscard]] TriangleMesh bake_light(const ProceduralObject& object, std::uint64_t seed);

}  // namespace resight
