// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <span>
#include <vector>

#include "resight/geometry/kd_tree.hpp"
#include "resight/geometry/point_cloud.hpp"
#include "resight/geometry/rigid3.hpp"
#include "resight/geometry/symmetry.hpp"
#include "resight/training/symmetry_detection.hpp"

namespace resight::internal {

/// Compares a surface with itself after a motion.
class SelfOverlap {
 public:
  /// `surface` must be finite, with normals and at least kMinPoints points.
  SelfOverlap(const PointCloud& surface, const SymmetryOptions& options);
  static constexpr std::size_t kMinPoints = 100;

  [[nodiscard]] const Eigen::Vector3d& center() const { return center_; }          ///< Centroid of the area, metres.
  [[nodiscard]] const Eigen::Matrix3d& covariance() const { return covariance_; }  ///< Covariance of the area, m^2.

  /// Length of the mean normal: 0 for a closed surface, 0.5 and more for the part of a body that one view shows.
  [[nodiscard]] double mean_normal_length() const { return mean_normal_length_; }

  /// Whether the motion maps the surface onto itself within the limits of the options.
  [[nodiscard]] bool is_symmetry(const Rigid3& motion) const;
  /// Share of the samples that the motion maps onto the surface with similar colours.
  [[nodiscard]] double share(const Rigid3& motion) const;
  /// Estimates share() from a few samples. Distances may be larger by the displacement that a rotation by `slack_rad`
  /// causes at the outermost point. Returns 0 if the share is below `min_share`.
  [[nodiscard]] double rough_share(const Rigid3& motion, double slack_rad, double min_share) const;
  /// Adjusts the axis so that rotations about it by each of the angles fit best (point-to-plane ICP with the axis as
  /// the only unknown; the angles are fixed).
  [[nodiscard]] RotationAxis refine(RotationAxis axis, std::span<const double> angles_rad) const;

 private:
  struct Limits {
    float distance_m = 0;
    float reach_m = 0;  // largest distance of a neighbour, including the distance along the surface
    int num_neighbors = 0;
  };
  enum class Match { kNone, kLike, kClose };  // rates the colours of a match on the surface
  [[nodiscard]] Match match(const Rigid3f& motion, int sample, const Limits& limits) const;
  [[nodiscard]] Match compare_colors(std::size_t i, std::size_t j) const;
  // Share of every stride-th sample that is at least kLike. Returns 0 as soon as one of the two minima cannot be
  // reached.
  [[nodiscard]] double share_of(const Rigid3& motion, int stride, const Limits& limits, double min_like,
                                double min_close) const;
  // The nearest point with a similar normal; -1 if there is none.
  [[nodiscard]] int find_partner(const Eigen::Vector3f& point, const Eigen::Vector3f& normal, double reach_m) const;

  PointCloud surface_;
  SymmetryOptions options_;
  KdTree tree_;
  std::vector<Eigen::Vector3f> colors_;  // blurred Y', Cb, Cr; empty if unknown
  std::vector<int> samples_;
  Eigen::Vector3d center_ = Eigen::Vector3d::Zero();
  Eigen::Matrix3d covariance_ = Eigen::Matrix3d::Zero();
  double mean_normal_length_ = 0;
  double radius_m_ = 0;  // distance of the outermost point from the centre
  float min_cosine_ = 0;
  Limits limits_;
};

}  // namespace resight::internal
