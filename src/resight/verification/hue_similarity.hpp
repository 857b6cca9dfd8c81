// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <span>

#include "resight/appearance/appearance_options.hpp"
#include "resight/appearance/lab_color.hpp"

namespace resight {

/// Cosine similarity of the chromaticities (a, b) of a model and of what is seen at the same points: near 1 if the hues
/// agree, whatever their saturation; another print of the same shape has other hues. It compares means over cubes of
/// AppearanceOptions::pattern_radius_m, because single points lie a little beside their place. A grey has no hue: each
/// point adds sigma_ab^2 as if it agreed. `expected`: the model under the light of the scene. 1 without
/// pattern_radius_m or points. One colour per point, or std::invalid_argument.
[[nodiscard]] double hue_similarity(std::span<const Eigen::Vector3f> points, std::span<const LabColor> expected,
                                    std::span<const LabColor> seen, const AppearanceOptions& options);

}  // namespace resight
