// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <span>

#include "resight/appearance/appearance_options.hpp"
#include "resight/appearance/lab_color.hpp"

namespace resight {

/// Cosine similarity of the chromaticities (a, b) of a model and of what is seen at the same points, in [-1, 1]. It is
/// near 1 if the hues agree, whatever their saturation. It compares means over cubes of side
/// AppearanceOptions::pattern_radius_m, because registration errors move single points to a neighbouring colour. Grey
/// has no hue: each point adds sigma_ab^2 of agreement, which outweighs the hue of nearly grey points. `expected`: the
/// model under the light of the scene. Returns 1 without pattern_radius_m or points. Throws std::invalid_argument
/// unless there is one colour per point.
[[nodiscard]] double hue_similarity(std::span<const Eigen::Vector3f> points, std::span<const LabColor> expected,
                                    std::span<const LabColor> seen, const AppearanceOptions& options);

}  // namespace resight
