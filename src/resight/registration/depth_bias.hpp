// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <limits>
#include <span>

#include "resight/core/options.hpp"
#include "resight/registration/view_alignment.hpp"
#include "resight/sensor/rgbd_frame.hpp"

namespace resight {

struct DepthBiasOptions {
  bool correct = false;
  int num_threads = 1;  ///< Same bits for any value >= 1.
  void check() const { check_options("DepthBiasOptions", *this); }
};

inline void declare(OptionVisitor& v, DepthBiasOptions& o) {
  v.field("correct", o.correct,
          "A bias of the depth that grows with the square of the distance is corrected. It is measured before the "
          "first view of a recorded sequence.",
          "ours");
  v.num_threads(o.num_threads);
}

/// A bias of depth as a wrong disparity causes it in stereo cameras and in cameras with structured light:
/// 1 / z = 1 / measured - per_m. At short range, z is measured + per_m * measured^2.
struct DepthBias {
  double per_m = 0;  ///< 1 / m. 0.007 is 1 cm at 1.2 m.
  /// Standard error: from noise, and from how far the halves of the images and of the depths disagree. Infinite if
  /// there are too few views.
  double sigma_per_m = std::numeric_limits<double>::infinity();
  int num_views = 0;  ///< In which it was measured.

  /// Whether it is worth a correction: more than three standard errors, and small enough to be a bias.
  [[nodiscard]] bool is_significant() const;
  /// A measured depth without the bias, which counts only if it is significant. NaN from where disparity ends.
  [[nodiscard]] float corrected_m(float measured_m) const;
};

/// Measures the bias from views of one static scene from several directions: only with the right depth do all views
/// agree on the surfaces. Poses and bias are adjusted together: point-to-plane distances between all pairs of views, as
/// in align_view(), and the given motions from view to view. Things that move meanwhile count as outliers. A camera
/// that stands still shows nothing: the standard error is large.
[[nodiscard]] DepthBias estimate_depth_bias(std::span<const AlignmentTarget> views, const DepthBiasOptions& options);

/// Corrects the depth of a frame. Does nothing unless the bias is significant.
void correct_depth(const DepthBias& bias, RgbdFrame& frame);

}  // namespace resight
