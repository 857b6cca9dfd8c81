// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <cstdint>
#include <span>

#include "resight/core/image.hpp"
#include "resight/registration/alignment_view.hpp"

namespace resight {

struct AlignViewOptions {
  double max_distance_m = 0.05;        ///< Farther pairs are no pairs, at the coarsest level.
  double min_distance_m = 0.008;       ///< The same at the finest level: beyond noise, within what changes.
  double max_normal_angle_rad = 0.6;   ///< Between the normals of a pair.
  double max_noise_sigmas = 3;         ///< Lower bound of a pair's gate, in standard deviations of both depths.
  double brightness_sigma = 12;        ///< Of brightness, grey levels; 0 = depth only.
  int num_levels = 8;                  ///< Levels used, from the finest; the views may have fewer.
  int max_iterations = 12;             ///< Per level.
  int max_samples = 6000;              ///< Points of the view used, evenly over the image, per level.
  double prior_sigma_m = 0;            ///< Of the given position; 0 = nothing is known of it.
  double prior_sigma_rad = 0;          ///< Of the given rotation; 0 = nothing is known of it.
  double information_per_pair = 0.25;  ///< Information of one pair: neighbouring pixels share errors.
  int num_threads = 1;                 ///< Same bits for any value >= 1.
  void check() const;
};

/// A view with a known pose that other views are aligned to.
struct AlignmentTarget {
  const AlignmentView* view = nullptr;
  Rigid3 world_from_camera;
};

/// A camera pose relative to the targets, and its quality at the finest level.
struct AlignedView {
  Rigid3 world_from_camera;
  /// Inverse covariance of a small motion of the camera in its own frame (rotation about x, y, z in rad, then
  /// translation in m), without the prior.
  Eigen::Matrix<double, 6, 6> information = Eigen::Matrix<double, 6, 6>::Zero();
  double overlap = 0;  ///< Share of the view's points that have a counterpart in a target.
  /// Share of the view's points that lie in front of the surface in every target that observes their place.
  double seen_through = 0;
  double mean_distance_m = 0;  ///< Mean absolute point-to-plane distance of the pairs.
  /// Correlation of brightness over the pairs; NaN if they show no texture beyond the noise of the images.
  double brightness_correlation = 0;
  int num_pairs = 0;
  double cost = 0;  ///< Mean truncated squared distance of the view's points to the nearest target, in [0, 1]. 0 if
                    ///< none can be compared: then no other pose is better.
};

/// Moves `view` from the given pose onto the targets, from coarse to fine: projective point-to-plane alignment
/// (Rusinkiewicz and Levoy 2001) in units of sensor noise, combined with brightness (Kerl, Sturm, Cremers 2013).
/// Tukey's weights suppress changed regions. Pairs of all targets count together. A view without any pair keeps its
/// pose. Throws std::invalid_argument if `view` has no level, or a target fewer levels than `view`.
[[nodiscard]] AlignedView align_view(const AlignmentView& view, std::span<const AlignmentTarget> targets,
                                     const Rigid3& world_from_camera, const AlignViewOptions& options = {});

/// Evaluates a pose without moving it: all fields of AlignedView at the finest level.
[[nodiscard]] AlignedView evaluate_alignment(const AlignmentView& view, std::span<const AlignmentTarget> targets,
                                             const Rigid3& world_from_camera, const AlignViewOptions& options = {});

/// Whether the brightness of a view and of a target rises and falls together in a block of the view's image.
enum class BlockSimilarity : std::uint8_t { kUnknown, kSimilar, kDissimilar };

/// Compares the brightness of the pairs at the finest level, in 8 x 6 blocks of the view's image. Unknown where few
/// pairs or no texture are. If an object stands in another place, its surroundings are dissimilar.
[[nodiscard]] Image<BlockSimilarity> compare_blocks(const AlignmentView& view, const AlignmentTarget& target,
                                                    const Rigid3& world_from_camera,
                                                    const AlignViewOptions& options = {});

}  // namespace resight
