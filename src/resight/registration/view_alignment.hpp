// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <span>

#include "resight/registration/alignment_view.hpp"

namespace resight {

struct AlignViewOptions {
  double max_distance_m = 0.05;        ///< Farther pairs are no pairs, at the coarsest level.
  double min_distance_m = 0.008;       ///< The same at the finest level: beyond noise, within what changes.
  double max_normal_angle_rad = 0.6;   ///< Between the normals of a pair.
  double max_noise_sigmas = 3;         ///< A pair may in any case be so far apart, in sigmas of both depths.
  double brightness_sigma = 12;        ///< Of brightness, grey levels; 0 = depth only.
  int num_levels = 8;                  ///< Levels used, from the finest; the views may have fewer.
  int max_iterations = 12;             ///< A level.
  int max_samples = 6000;              ///< Points of the view used, evenly over the image, a level.
  double prior_sigma_m = 0;            ///< Of the given position; 0 = nothing is known of it.
  double prior_sigma_rad = 0;          ///< Of the given rotation; 0 = nothing is known of it.
  double information_per_pair = 0.25;  ///< Errors of neighbouring pixels are alike: one pair tells so much of what an
                                       ///< independent one would.
  int num_threads = 1;                 ///< Same bits for any value >= 1.
  void check() const;
};

/// A view with a known pose, to align to.
struct AlignmentTarget {
  const AlignmentView* view = nullptr;
  Rigid3 world_from_camera;
};

struct AlignedView {
  Rigid3 world_from_camera;
  /// Inverse covariance of a small motion of the camera in its own frame (rotation about x, y, z in rad, then shift in
  /// m), without the prior.
  Eigen::Matrix<double, 6, 6> information = Eigen::Matrix<double, 6, 6>::Zero();
  double overlap = 0;          ///< Share of the view's points that have a counterpart in a target.
  double seen_through = 0;     ///< Share of them that lie in front of what all targets that see there show.
  double mean_distance_m = 0;  ///< Of the pairs, point to plane, absolute.
  /// Between the brightness of the pairs; NaN where there is no print.
  double brightness_correlation = 0;
  int num_pairs = 0;
};

/// Moves `view` from the given pose onto the targets: projective point-to-plane alignment (Rusinkiewicz and Levoy 2001)
/// in units of the sensor's noise together with brightness (Kerl, Sturm, Cremers 2013), from coarse to fine, with
/// Tukey's weights, so that what has changed between the views does not pull. Pairs of all targets count together. Each
/// target must have as many levels as `view`. A view without any pair stays where it is.
[[nodiscard]] AlignedView align_view(const AlignmentView& view, std::span<const AlignmentTarget> targets,
                                     const Rigid3& world_from_camera, const AlignViewOptions& options = {});

/// How well a pose stands, without moving it: all of AlignedView at the finest level.
[[nodiscard]] AlignedView judge_alignment(const AlignmentView& view, std::span<const AlignmentTarget> targets,
                                          const Rigid3& world_from_camera, const AlignViewOptions& options = {});

}  // namespace resight
