// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "resight/geometry/camera.hpp"
#include "resight/sensor/organized_cloud.hpp"

namespace resight {

/// Eq. (2) between a cloud and a view, exactly, without an index over the view: a point is explained where a point of
/// the view lies within the tolerance, and such a point projects nearby. `view_in_camera` must be what `camera` saw
/// (back_project()). For each point, camera frame, whether a pixel explains it; 0 for NaN. `explained_pixels`, if
/// given, has the view's size: the pixels that were found to have one of the points within the tolerance become
/// 1 (most of those that have one, not all).
[[nodiscard]] std::vector<std::uint8_t> find_explained_points(std::span<const Eigen::Vector3f> points_in_camera,
                                                              const OrganizedCloud& view_in_camera,
                                                              const Camera& camera, double tolerance_m,
                                                              int num_threads = 1,
                                                              Image<std::uint8_t>* explained_pixels = nullptr);

/// The other way round: ascending pixels of the view that no point explains. Pixels that `explained_pixels` marks are
/// known to be explained; an empty image says nothing.
[[nodiscard]] std::vector<int> find_unexplained_pixels(std::span<const Eigen::Vector3f> points_in_camera,
                                                       const OrganizedCloud& view_in_camera, const Camera& camera,
                                                       double tolerance_m, int num_threads = 1,
                                                       const Image<std::uint8_t>& explained_pixels = {});

/// Ascending pixels of the view that have one of the points within `distance_m`.
[[nodiscard]] std::vector<int> find_pixels_near(std::span<const Eigen::Vector3f> points_in_camera,
                                                const OrganizedCloud& view_in_camera, const Camera& camera,
                                                double distance_m, int num_threads = 1);

}  // namespace resight
