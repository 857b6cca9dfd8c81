// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <vector>

#include "resight/sensor/prepared_view.hpp"

namespace resight {

/// What alignment needs of a view, at one resolution. Camera frame, metres. NaN in z = no measurement. NaN in nx = no
/// normal, or the point must not be aligned (masked out, or near a depth edge).
struct AlignmentLevel {
  Camera camera;
  OrganizedCloud cloud;
  Image<float> sigma_m;  ///< Axial noise of each point.
  /// Grey values (0..255) minus their local mean, which removes the overall brightness.
  Image<float> brightness;
};

struct AlignmentViewOptions {
  int num_levels = 3;               ///< Halves of the image: 1/2, 1/4, 1/8 of its width.
  double min_edge_distance_px = 3;  ///< Points nearer to a depth edge are seen, but not aligned.
  double mean_radius = 0.05;        ///< Of the local mean of brightness, as a share of the image's width.
  void check() const;
};

/// A view as a pyramid, finest level (half resolution) first. About 5 MB for 640x480.
struct AlignmentView {
  std::vector<AlignmentLevel> levels;
};

/// Builds the pyramid of a view with normals. `mask` has the frame's size; points with a non-zero value are aligned.
/// Points that are masked out still occlude. Throws std::invalid_argument if the view has no normals or the mask
/// another size.
[[nodiscard]] AlignmentView make_alignment_view(const PreparedView& view, const AlignmentViewOptions& options = {},
                                                const Image<std::uint8_t>* mask = nullptr);

}  // namespace resight
