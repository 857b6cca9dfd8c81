// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <span>
#include <vector>

#include "resight/appearance/appearance_options.hpp"
#include "resight/appearance/lab_color.hpp"

namespace resight {

/// Averages colours over the surroundings of each point of a surface. What a noisy view and a scan share is the texture
/// that both resolve; noise, sharpening and small highlights are none.
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

/// pattern_similarity() of the colours of a model and of the scene at `points`, both blurred by
/// AppearanceOptions::pattern_radius_m. One colour per point, or std::invalid_argument.
[[nodiscard]] double surface_pattern_similarity(std::span<const Eigen::Vector3f> points,
                                                std::span<const LabColor> expected, std::span<const LabColor> seen,
                                                const AppearanceOptions& options);

}  // namespace resight
