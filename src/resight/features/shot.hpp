// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "resight/features/feature_set.hpp"
#include "resight/geometry/point_cloud.hpp"
#include "resight/sensor/prepared_view.hpp"

namespace resight {

struct ShotOptions {
  double keypoint_spacing_m = 0.01;  ///< Uniform sampling (paper; V4R: 1 cm).
  double support_radius_m = 0.04;    ///< V4R: 4 cm.
  double support_voxel_m = 0.005;    ///< The surface is thinned to this before description; 0 keeps every pixel.
  /// l0 / (l0 + l1 + l2) of the support around its mean: flatter keypoints are dropped; 0 keeps all. In extract_shot()
  /// the variance of the sensor's axial noise is taken off l0 first: at 2 m it alone makes a wall look curved.
  double min_surface_variation = 0.01;
  double max_keypoint_depth_m = 0;  ///< Of extract_shot(): no keypoints farther away (later V4R: 1.8 m); 0 = no limit.
  int min_neighbors = 10;           ///< Fewer support points: no descriptor.
  int num_threads = 1;              ///< Same bits for any value >= 1.
  void check() const;
};

/// SHOT-352 (Tombari, Salti, Di Stefano 2010) of `keypoints` over `support` as it stands (not thinned again); both with
/// normals, in the same frame. Keypoints without a stable descriptor are left out: too few neighbours, too flat, not
/// finite, or a frame that is not defined (local_reference_frame()). `kept`, if given, receives the indices of the
/// others.
[[nodiscard]] FeatureSet describe_shot(const PointCloud& support, const PointCloud& keypoints,
                                       const ShotOptions& options = {}, std::vector<int>* kept = nullptr);

/// Uniformly sampled, non-planar keypoints of a view and their SHOT over its surface (within `mask` if given: keypoints
/// AND support). A keypoint is the point of the thinned surface nearest to the centre of its cube of
/// keypoint_spacing_m. Camera frame.
[[nodiscard]] FeatureSet extract_shot(const PreparedView& view, const ShotOptions& options = {},
                                      const Image<std::uint8_t>* mask = nullptr);

}  // namespace resight
