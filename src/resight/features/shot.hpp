// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>

#include "resight/core/options.hpp"
#include "resight/features/feature_set.hpp"
#include "resight/geometry/point_cloud.hpp"
#include "resight/sensor/prepared_view.hpp"

namespace resight {

struct ShotOptions {
  double keypoint_spacing_m = 0.01;
  double support_radius_m = 0.04;
  std::optional<double> support_voxel_m = 0.005;
  double min_surface_variation = 0.01;
  std::optional<double> max_keypoint_depth_m = 2.0;
  int min_neighbors = 10;
  int num_threads = 1;  ///< Same bits for any value >= 1.
  void check() const { check_options("ShotOptions", *this); }
};

inline void declare(OptionVisitor& v, ShotOptions& o) {
  v.field("keypoint_spacing_m", o.keypoint_spacing_m, positive(), "Spacing of the keypoints (uniform sampling).",
          "paper; V4R");
  v.field("support_radius_m", o.support_radius_m, positive(), "Radius of the surface that is described.", "V4R");
  v.field("support_voxel_m", o.support_voxel_m, positive(),
          "The surface is downsampled to this before description. off: every pixel is used.");
  v.field("min_surface_variation", o.min_surface_variation, between(0, 1.0 / 3),
          "Keypoints on flatter surface are dropped: smallest eigenvalue of the support over the sum of all, without "
          "the variance of the sensor noise. 0: all are kept.");
  v.field("max_keypoint_depth_m", o.max_keypoint_depth_m, positive(),
          "Points of a view beyond this depth are no keypoints: normals are noise there. off: no limit.",
          "later V4R: 1.8");
  v.field("min_neighbors", o.min_neighbors, between(3, 1e9), "Keypoints with fewer support points are not described.");
  v.num_threads(o.num_threads);
}

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
