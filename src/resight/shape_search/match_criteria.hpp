// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>

#include "resight/appearance/appearance_options.hpp"

namespace resight {

/// What the shape search shares with the verification, so that both agree on what fits.
struct MatchCriteria {
  AppearanceOptions appearance{};
  double min_weight = 0.8;              ///< Weight by colour from which a sample is explained.
  double min_pattern_similarity = 0.5;  ///< -1: any.
  /// ContinuationClutter::texture_contrast: what lies on a plane larger than the object is the object's as far as it
  /// shares its texture (weigh_shared_texture()). None: it is not.
  std::optional<double> texture_contrast{};
  /// Objects that are round in shape but not in texture (a can; more than 12 rotations) are searched by shape alone,
  /// and then rotated about their axis in such steps to where the texture fits best. One pose per place is kept.
  std::optional<double> symmetry_step_rad{};
};

}  // namespace resight
