// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <vector>

#include "resight/geometry/point_cloud.hpp"
#include "resight/sensor/prepared_view.hpp"

namespace resight {

/// Measured or sampled points on the surface of an object, with normals, colours and uncertainty.
struct SurfaceSamples {
  PointCloud cloud;
  std::vector<float> sigma_m;  ///< Standard deviation of each point, > 0.
};

/// Collects the points of a view under `mask` (non-zero = object; size of the camera image) that have a normal and are
/// more than `min_edge_distance_px` from every depth discontinuity, where points mix object and background. Points are
/// in the object frame; frame.world_from_camera is object_from_camera. sigma combines lateral and axial noise.
[[nodiscard]] SurfaceSamples collect_surface_samples(const PreparedView& view, const Image<std::uint8_t>& mask,
                                                     double min_edge_distance_px);

/// Fuses samples to one point per cube of side `voxel_size_m`: their mean weighted by 1 / sigma^2. Both sides of a wall
/// thinner than a cube stay apart: samples whose normals differ by more than 120 deg from that of the most certain
/// sample form a second point. Cubes are in order of their first samples. Throws std::invalid_argument if sigmas,
/// normals or colours are missing.
[[nodiscard]] PointCloud fuse_surface(const SurfaceSamples& samples, double voxel_size_m);

}  // namespace resight
