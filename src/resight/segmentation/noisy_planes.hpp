// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "resight/segmentation/scene_planes.hpp"

namespace resight {

struct NoisyPlanesOptions {
  double min_extent_m = 0.4;  ///< Smaller planes are not sought.
  std::uint64_t seed = 1;     ///< Of the random triples.
};

/// Finds large planes that sensor noise hides from find_scene_planes(), such as a floor at 2 m, where the normals of
/// neighbours differ by tens of degrees. Planes through random triples of points compete (RANSAC, Fischler and Bolles
/// 1981). The tolerance of a point follows its own noise. Real sensors are noisier than their models, so the scale of
/// the noise is estimated from the residuals of each plane (ScenePlane::noise_scale). A plane must hold nearly all
/// points around it, which rejects planes through the faces of several objects.
/// `noise_m`: standard deviation of each point across the plane, by the noise model. `candidates`: indices of the
/// points that may be on a plane. Throws std::invalid_argument if normals or noise are not one per point.
[[nodiscard]] std::vector<ScenePlane> find_noisy_planes(std::span<const Eigen::Vector3f> points,
                                                        std::span<const Eigen::Vector3f> normals,
                                                        std::span<const float> noise_m, std::vector<int> candidates,
                                                        const NoisyPlanesOptions& options = {});

}  // namespace resight
