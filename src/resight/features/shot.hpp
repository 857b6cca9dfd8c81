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

/// Computes SHOT-352 (Tombari, Salti, Di Stefano 2010) of `keypoints` over `support`, which is not downsampled further.
/// Both need normals and must be in the same frame. Keypoints without a stable descriptor are left out: too few
/// neighbours, too flat, not finite, or without a local_reference_frame(). `kept`, if given, receives the indices of
/// the described keypoints. Throws std::invalid_argument if normals are missing.
[[nodiscard]] FeatureSet describe_shot(const PointCloud& support, const PointCloud& keypoints,
                                       const ShotOptions& options = {}, std::vector<int>* kept = nullptr);

/// Samples non-planar keypoints of a view uniformly and computes their SHOT over its surface, in the camera frame.
/// `mask`, if given, restricts keypoints and support (non-zero = use; size of the camera image). A keypoint is the
/// point of the downsampled surface nearest to the centre of its cube of side keypoint_spacing_m.
[[nodiscard]] FeatureSet extract_shot(const PreparedView& view, const ShotOptions& options = {},
                                      const Image<std::uint8_t>* mask = nullptr);

}  // namespace resight
