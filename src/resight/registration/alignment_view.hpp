// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <vector>

#include "resight/sensor/prepared_view.hpp"

namespace resight {

/// What the alignment of views needs of one, at one resolution. Camera frame, metres; NaN in z = no measurement, NaN in
/// nx = none, no normal, or not to be used (masked, at a depth edge).
struct AlignmentLevel {
  Camera camera;
  OrganizedCloud cloud;
  Image<float> sigma_m;     ///< Axial noise of each point.
  Image<float> brightness;  ///< Grey values (0..255) less their local mean: the light's level is left out.
};

struct AlignmentViewOptions {
  int num_levels = 3;               ///< Halves of the image: 1/2, 1/4, 1/8 of its width.
  double min_edge_distance_px = 3;  ///< Points nearer to a depth edge are seen, but not aligned.
  double mean_radius = 0.05;        ///< Of the local mean of brightness, as a share of the image's width.
  void check() const;
};

/// A view as a pyramid, finest level first. About 5 MB for 640x480.
struct AlignmentView {
  std::vector<AlignmentLevel> levels;
};

/// `mask`: of the frame's size, non-zero = use for alignment; what is masked out still hides what lies behind it.
[[nodiscard]] AlignmentView make_alignment_view(const PreparedView& view, const AlignmentViewOptions& options = {},
                                                const Image<std::uint8_t>* mask = nullptr);

}  // namespace resight
