// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <span>
#include <vector>

#include "resight/geometry/kd_tree.hpp"
#include "resight/geometry/point_cloud.hpp"
#include "resight/geometry/rigid3.hpp"
#include "resight/training/symmetry_detection.hpp"

namespace resight::internal {

/// A line that an object is turned about, object frame.
struct TurnAxis {
  Eigen::Vector3d direction = Eigen::Vector3d::UnitZ();  ///< Unit.
  Eigen::Vector3d point = Eigen::Vector3d::Zero();       ///< Metres.
};

[[nodiscard]] Rigid3 turn_about(const TurnAxis& axis, double angle_rad);

/// A surface that is compared with itself after a motion.
class SelfOverlap {
 public:
  /// `surface`: finite, with normals; at least kMinPoints points.
  SelfOverlap(const PointCloud& surface, const SymmetryOptions& options);
  static constexpr std::size_t kMinPoints = 100;

  [[nodiscard]] const Eigen::Vector3d& center() const { return center_; }          ///< Of the area, metres.
  [[nodiscard]] const Eigen::Matrix3d& covariance() const { return covariance_; }  ///< Of the area, m^2.

  /// Length of the mean normal: 0 for a closed surface, 0.5 and more for what is seen of a body in one view.
  [[nodiscard]] double mean_normal_length() const { return mean_normal_length_; }

  /// Whether the motion puts the surface onto itself, by the limits of the options.
  [[nodiscard]] bool is_symmetry(const Rigid3& motion) const;
  /// The share of the samples that it puts onto the surface, in like colour.
  [[nodiscard]] double share(const Rigid3& motion) const;
  /// The share of a few samples that come to lie on the surface if distances may be larger: by what a rotation of
  /// `slack_rad` moves the outermost point. 0 if it is below `min_share`.
  [[nodiscard]] double rough_share(const Rigid3& motion, double slack_rad, double min_share) const;
  /// The axis moved so that turns about it by each of the angles fit best (point-to-plane ICP over the axis alone: the
  /// angles stay).
  [[nodiscard]] TurnAxis refine(TurnAxis axis, std::span<const double> angles_rad) const;

 private:
  struct Limits {
    float distance_m = 0;
    float reach_m = 0;  // of a neighbour, distance along the surface included
    int num_neighbors = 0;
  };
  enum class Match { kNone, kLike, kClose };  // of what lies on the surface: its colours
  [[nodiscard]] Match match(const Rigid3f& motion, int sample, const Limits& limits) const;
  [[nodiscard]] Match compare_colors(std::size_t i, std::size_t j) const;
  // Share of every stride-th sample that is at least like; 0 as soon as one of the two minima is out of reach.
  [[nodiscard]] double share_of(const Rigid3& motion, int stride, const Limits& limits, double min_like,
                                double min_close) const;
  // The nearest point that faces the same way; -1 if there is none.
  [[nodiscard]] int find_partner(const Eigen::Vector3f& point, const Eigen::Vector3f& normal, double reach_m) const;

  PointCloud surface_;
  SymmetryOptions options_;
  KdTree tree_;
  std::vector<Eigen::Vector3f> colors_;  // blurred Y', Cb, Cr; empty if not known
  std::vector<int> samples_;
  Eigen::Vector3d center_ = Eigen::Vector3d::Zero();
  Eigen::Matrix3d covariance_ = Eigen::Matrix3d::Zero();
  double mean_normal_length_ = 0;
  double radius_m_ = 0;  // of the outermost point, about the centre
  float min_cosine_ = 0;
  Limits limits_;
};

}  // namespace resight::internal
