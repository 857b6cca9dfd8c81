// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <vector>

#include "resight/core/options.hpp"
#include "resight/geometry/point_cloud.hpp"
#include "resight/segmentation/scene_planes.hpp"
#include "resight/sensor/prepared_view.hpp"

namespace resight {

struct SampleSceneOptions {
  double spacing_m = 0.008;
  double max_depth_m = 2.0;
  double min_edge_distance_px = 2;
  std::uint64_t seed = 1;
  int num_threads = 1;  ///< Same bits for any value >= 1.
  void check() const { check_options("SampleSceneOptions", *this); }
};

inline void declare(OptionVisitor& v, SampleSceneOptions& o) {
  v.field("spacing_m", o.spacing_m, positive(), "One scene point per voxel of this size.");
  v.field("max_depth_m", o.max_depth_m, positive(), "Farther points are not searched: their normals say little.");
  v.field("min_edge_distance_px", o.min_edge_distance_px, at_least(0),
          "Points nearer to a depth edge are not searched: normals are bent there. 0: all are.");
  v.seed(o.seed);
  v.num_threads(o.num_threads);
}

/// A downsampled view with mean normals and colours. Camera frame.
struct SceneSamples {
  PointCloud points;               ///< Those that may belong to an object: not of large planes.
  std::vector<ScenePlane> planes;  ///< Of any size.
};

/// Points of planes larger than this (tables, walls) are not searched, unless an object sought is as large.
inline constexpr double kMaxPlane_m = 0.4;

[[nodiscard]] SceneSamples sample_scene(const PreparedView& view, const SampleSceneOptions& options = {},
                                        double max_plane_m = kMaxPlane_m);

/// A subset of a surface with normals, no two points of similar normal nearer than `spacing_m`; normals are means over
/// the surroundings of `spacing_m`, so that edges are as round as a sensor sees them. The spacing grows until at most
/// `max_points` are left. In random order: any first part of them is spread over the whole surface.
[[nodiscard]] PointCloud sample_surface(const PointCloud& surface, double spacing_m, int max_points);

}  // namespace resight
