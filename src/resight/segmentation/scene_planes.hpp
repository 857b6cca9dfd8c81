// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <cmath>
#include <span>
#include <vector>

#include "resight/segmentation/smooth_segments.hpp"

namespace resight {

struct FindPlanesOptions {
  double max_distance_m = 0.01;     ///< Of a plane's points (V4R: 2 cm, which swallows boxes that lie flat).
  double max_angle_rad = 0.523599;  ///< Of their normals (V4R: 30 deg).
  int min_points = 5000;            ///< At the resolution of a full view (1/525 m at 1 m); scaled to the cloud's.
  int num_threads = 1;              ///< Same bits for any value >= 1.
  void check() const;
};

/// A dominant plane of the scene (table, wall, shelf) in the world frame: normal . p = offset. The normal faces the
/// cameras. The plane is bounded and says nothing about space beyond its visible part.
struct ScenePlane {
  Eigen::Vector3f normal = Eigen::Vector3f::UnitZ();
  float offset = 0;
  float extent_m = 0;  ///< Largest distance between two of its points.
  int num_points = 0;
  /// Standard deviation of its points over that of the noise model, if that is what decides which points are on it
  /// (find_noisy_planes()); 0: a constant distance decides.
  float noise_scale = 0;

  static constexpr float kToleranceSigmas = 2.5F;
  static constexpr float kMinNoisyDot = 0.5F;  ///< Cosine of 60 deg, between the plane and a noisy normal on it.
  /// Largest distance of a point on a noisy plane, where the model gives the noise `noise_m`.
  [[nodiscard]] float tolerance_m(float noise_m) const { return kToleranceSigmas * noise_scale * noise_m; }

  [[nodiscard]] float signed_distance(const Eigen::Vector3f& p) const { return normal.dot(p) - offset; }
  /// Whether the foot of `p` lies within the outline of the plane: in a cell between observed points of its row and of
  /// its column. Holes (under objects) are included.
  [[nodiscard]] bool covers(const Eigen::Vector3f& p) const;
  /// Whether a surface point with this normal belongs to the plane.
  [[nodiscard]] bool holds(const Eigen::Vector3f& p, const Eigen::Vector3f& n, float max_distance_m,
                           float min_dot) const {
    return std::abs(signed_distance(p)) <= max_distance_m && normal.dot(n) >= min_dot && covers(p);
  }

  Eigen::Vector3f axis_u = Eigen::Vector3f::UnitX();
  Eigen::Vector3f axis_v = Eigen::Vector3f::UnitY();
  Eigen::Vector2f origin_uv = Eigen::Vector2f::Zero();
  struct Range {
    int first = 1;
    int last = 0;  ///< Inclusive; last < first: empty.
  };
  std::vector<Range> rows;     ///< Per cell in v: covered cells in u.
  std::vector<Range> columns;  ///< Per cell in u: covered cells in v.
};

/// The planes of a cloud, and the plane of each of its points.
struct ScenePlanes {
  std::vector<ScenePlane> planes;
  std::vector<int> plane_of_point;  ///< -1 if the point is in no plane.
};

/// Finds planes in a cloud with spacing `spacing_m`. Fits planes to large smooth segments, then collects all points
/// within max_distance_m and max_angle_rad of them, so that coplanar pieces of one table become one plane. V4R grows
/// regions and requires 5,000 pixels. A reconstruction has fewer points for the same area, so the count is scaled from
/// the spacing of a full view (1/525 m at 1 m) to that of the cloud.
[[nodiscard]] ScenePlanes find_scene_planes(std::span<const Eigen::Vector3f> points,
                                            std::span<const Eigen::Vector3f> normals, const SmoothSegments& segments,
                                            double spacing_m, const FindPlanesOptions& options);

/// Same for a cloud downsampled to `spacing_m`; computes the segments itself.
[[nodiscard]] ScenePlanes find_planes_of_downsampled(std::span<const Eigen::Vector3f> points,
                                                     std::span<const Eigen::Vector3f> normals, double spacing_m,
                                                     const FindPlanesOptions& options);

/// Index of the first plane that each point belongs to, or -1.
[[nodiscard]] std::vector<int> assign_to_planes(std::span<const Eigen::Vector3f> points,
                                                std::span<const Eigen::Vector3f> normals,
                                                std::span<const ScenePlane> planes, const FindPlanesOptions& options);

}  // namespace resight
