// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "resight/segmentation/scene_planes.hpp"

namespace resight {

struct NoisyPlanesOptions {
  double min_extent_m = 0.4;  ///< Smaller planes are not sought.
  int min_points = 300;       ///< Of a plane.
  std::uint64_t seed = 1;     ///< Of the random triples.
};

/// Finds the large planes that sensor noise hides from find_scene_planes(): a floor at 2 m, where the normals of
/// neighbours differ by tens of degrees. Planes through random triples of points compete (RANSAC, Fischler and Bolles
/// 1981). Points are weighed by their own noise, whose scale is estimated from the residuals of each plane, as sensors
/// are noisier than their models; see ScenePlane::noise_scale. A plane counts only if it holds nearly all points around
/// it: faces that happen to lie in one plane do not.
/// `noise_m`: standard deviation of each point across the plane, as modelled. `candidates`: the points to search.
[[nodiscard]] std::vector<ScenePlane> find_noisy_planes(std::span<const Eigen::Vector3f> points,
                                                        std::span<const Eigen::Vector3f> normals,
                                                        std::span<const float> noise_m, std::vector<int> candidates,
                                                        const NoisyPlanesOptions& options = {});

}  // namespace resight
