// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <cmath>
#include <vector>

#include "resight/sensor/prepared_view.hpp"

namespace resight {

/// What alignment needs of a pixel. Camera frame, metres. It fills half a cache line, so that a pair, which may lie
/// anywhere in the image, costs one access to memory.
struct alignas(32) AlignmentPoint {
  Eigen::Vector3f position;  ///< NaN = no measurement.
  float sigma_m = 0;         ///< Axial noise.
  Eigen::Vector3f normal;    ///< NaN = none or no measurement, or not to be aligned (masked out, near a depth edge).
  float brightness = 0;      ///< Grey value (0..255) minus the local mean, which removes the overall brightness.

  [[nodiscard]] bool is_measured() const { return !std::isnan(position.z()); }
  [[nodiscard]] bool has_normal() const { return !std::isnan(normal.x()); }
};

/// A view at one resolution.
struct AlignmentLevel {
  Camera camera;
  Image<AlignmentPoint> points;
};

struct AlignmentViewOptions {
  int num_levels = 3;               ///< Halves of the image: 1/2, 1/4, 1/8 of its width.
  double min_edge_distance_px = 3;  ///< Points nearer to a depth edge are seen, but not aligned.
  double mean_radius = 0.05;        ///< Of the local mean of brightness, as a share of the image's width.
  void check() const;
};

/// A view as a pyramid, finest level (half resolution) first. About 3 MB for 640x480.
struct AlignmentView {
  std::vector<AlignmentLevel> levels;
  double brightness_noise = 0;  ///< Standard deviation at the finest level.
};

/// Builds the pyramid of a view with normals. `mask` has the frame's size; points with a non-zero value are aligned.
/// Points that are masked out still occlude. Throws std::invalid_argument if the view has no normals or the mask
/// another size.
[[nodiscard]] AlignmentView make_alignment_view(const PreparedView& view, const AlignmentViewOptions& options = {},
                                                const Image<std::uint8_t>* mask = nullptr);

}  // namespace resight
