// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "resight/geometry/rigid3.hpp"
#include "resight/registration/alignment_view.hpp"
#include "resight/registration/view_alignment.hpp"

namespace resight {

/// Which points of all views are compared. A wrong lens makes centre and border disagree, another law near and far;
/// noise and too few directions, any two halves.
enum class ViewPart : std::uint8_t { kAll, kCenter, kBorder, kNear, kFar, kLeft, kRight };

inline constexpr std::array<std::pair<ViewPart, ViewPart>, 3> kHalvesOfViews = {{
    {ViewPart::kCenter, ViewPart::kBorder},
    {ViewPart::kNear, ViewPart::kFar},
    {ViewPart::kLeft, ViewPart::kRight},
}};

/// The poses of views and their common bias.
struct BiasEstimate {
  std::vector<Rigid3> world_from_camera;
  double per_m = 0;        ///< DepthBias::per_m.
  double sigma_per_m = 0;  ///< From noise alone.
};

/// Least squares of poses and bias over the point-to-plane distances of all pairs of views, and the given motions.
class BiasAdjustment {
 public:
  /// `views` must outlive it.
  BiasAdjustment(std::span<const AlignmentTarget> views, int num_threads);

  /// From the given poses, with ever nearer pairs.
  [[nodiscard]] BiasEstimate solve() const;
  /// Of a part of the points, from a solution for all.
  [[nodiscard]] BiasEstimate solve_part(BiasEstimate estimate, ViewPart part) const;

 private:
  struct Sample {
    Eigen::Vector3d point;  // Camera frame, as measured.
    Eigen::Vector3d normal;
    double variance_m2 = 0;
  };
  struct Equations;
  [[nodiscard]] static std::vector<Sample> draw_samples(const AlignmentLevel& level);
  [[nodiscard]] bool contains(ViewPart part, const Eigen::Vector3d& point) const;
  [[nodiscard]] Equations compare(const BiasEstimate& estimate, ViewPart part, double gate_m,
                                  std::pair<std::size_t, std::size_t> pair) const;
  void add_given_motions(const BiasEstimate& estimate, Eigen::MatrixXd& matrix, Eigen::VectorXd& right) const;
  void step(BiasEstimate& estimate, ViewPart part, double gate_m) const;

  std::span<const AlignmentTarget> views_;
  int num_threads_;
  std::vector<std::vector<Sample>> samples_;                // Per view.
  std::vector<std::pair<std::size_t, std::size_t>> pairs_;  // Points of one view, surfaces of the other.
  double middle_radius_ = 0;
  double middle_depth_m_ = 0;
};

}  // namespace resight
