// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>

#include "resight/core/image.hpp"
#include "resight/core/random.hpp"
#include "resight/simulation/procedural_objects.hpp"
#include "resight/simulation/texture_designs.hpp"

namespace resight {

// Shapes whose every part is drawn from a random stream.

/// A body of revolution with a smooth random profile, printed or of one colour.
[[nodiscard]] ProceduralObject make_turned_object(const std::string& name, Rng rng, bool is_plain);
/// Three to five blocks, cylinders and ellipsoids on top of each other and side by side, with prints.
[[nodiscard]] ProceduralObject make_composite_object(const std::string& name, Rng rng);
/// A cup with a handle, printed or of one colour.
[[nodiscard]] ProceduralObject make_seeded_cup(const std::string& name, Rng rng, bool is_plain);
/// An untextured bowl.
[[nodiscard]] ProceduralObject make_seeded_bowl(const std::string& name, Rng rng);
/// An untextured cylinder.
[[nodiscard]] ProceduralObject make_plain_cylinder(const std::string& name, Rng rng);

/// A colour as paint and plastic have it.
[[nodiscard]] Rgb8 random_paint(Rng& rng);
/// The style of a print: a word, a hue and a seed.
[[nodiscard]] TextureStyle random_style(Rng& rng);

}  // namespace resight
