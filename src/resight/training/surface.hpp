// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <span>
#include <vector>

#include "resight/geometry/point_cloud.hpp"
#include "resight/sensor/prepared_view.hpp"

namespace resight {

/// Measured or sampled points of an object's surface, with normals and colours, and how far each may be off.
struct SurfaceSamples {
  PointCloud cloud;
  std::vector<float> sigma_m;  ///< Standard deviation, > 0, as long as the cloud.
};

/// The points of a view under `mask` (non-zero = object; the camera's size) that have a normal and lie more than
/// `min_edge_distance_px` away from every depth discontinuity (beside one, points are mixtures of object and
/// background). In the object frame; frame.world_from_camera is object_from_camera. sigma: lateral and axial noise
/// together.
[[nodiscard]] SurfaceSamples collect_surface_samples(const PreparedView& view, const Image<std::uint8_t>& mask,
                                                     double min_edge_distance_px);

/// One point per cube of side `voxel_size_m`: the mean of its samples weighted by 1 / sigma^2. The two sides of a wall
/// thinner than a cube stay apart: samples that face more than 120 deg away from the cube's best one make up a point of
/// their own. In order of each cube's first sample.
[[nodiscard]] PointCloud fuse_surface(const SurfaceSamples& samples, double voxel_size_m);

}  // namespace resight
