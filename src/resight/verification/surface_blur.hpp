// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <span>
#include <vector>

#include "resight/appearance/appearance_match.hpp"

namespace resight {

/// Averages colours over the surroundings of each point of a surface. This suppresses image noise, sharpening and small
/// highlights, which a scan does not share.
class SurfaceBlur {
 public:
  /// Averages over points nearer than `radius_m`.
  SurfaceBlur(std::span<const Eigen::Vector3f> points, double radius_m);
  /// One colour per point. Throws std::invalid_argument for another number.
  [[nodiscard]] std::vector<LabColor> operator()(std::span<const LabColor> colors) const;

 private:
  std::vector<int> begin_;  // CSR: the neighbours of each point, itself among them.
  std::vector<int> neighbors_;
};

/// match_texture() at `points`. If AppearanceOptions::pattern_radius_m is set, the similarity of an untextured model
/// (below kMinTextureContrast) is that of the blurred colours relative to the mean of their surroundings, within three
/// radii: light changes slowly along a surface, most of all in a hollow or glossy one, and is no pattern. One colour
/// per point, or std::invalid_argument.
[[nodiscard]] TextureMatch match_surface_texture(std::span<const Eigen::Vector3f> points,
                                                 std::span<const LabColor> model, std::span<const LabColor> expected,
                                                 std::span<const LabColor> seen, const AppearanceOptions& options);

}  // namespace resight
