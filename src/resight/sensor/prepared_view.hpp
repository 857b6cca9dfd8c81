// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>

#include "resight/core/options.hpp"
#include "resight/sensor/depth_edges.hpp"
#include "resight/sensor/noise_model.hpp"
#include "resight/sensor/organized_cloud.hpp"
#include "resight/sensor/rgbd_frame.hpp"

namespace resight {

/// 1920 x 1080 pixels are within it. More pixels show no more of an object at the resolution of its model.
inline constexpr int kMaxWorkingPixels = 1 << 21;

struct PrepareViewOptions {
  std::optional<int> max_pixels{};
  ComputeNormalsOptions normals{};
  DepthEdgeOptions edges{};
  std::optional<double> min_depth_m = 0.15;
  std::optional<double> max_depth_m{};
  std::optional<double> color_width_m{};
  int num_threads = 1;  ///< Of all steps (normals.num_threads is not used). Same bits for any value >= 1.
  void check() const { check_options("PrepareViewOptions", *this); }
};

inline void declare(OptionVisitor& v, PrepareViewOptions& o) {
  v.field("max_pixels", o.max_pixels, at_least(1),
          "A view with more pixels is reduced to 1/2, 1/3, ... of its width and height, which bounds time and memory. "
          "off: never.");
  v.group("normals", o.normals);
  v.group("edges", o.edges);
  v.field("min_depth_m", o.min_depth_m, positive(),
          "Nearer measurements count as missing: only cameras for close range measure there, and surfaces so close are "
          "often parts of the robot itself. off: all are kept.");
  v.field(
      "max_depth_m", o.max_depth_m, positive(),
      "Farther points are dropped from the point cloud. The depth image stays whole: beyond, it is still evidence of "
      "free space. off: all points are kept.");
  v.field(
      "color_width_m", o.color_width_m, positive(),
      "In a noisy image, colours that are compared with those of a model are averaged: over as many pixels as bring "
      "the noise down to one grey level, but over no more than this width on the surface. off: single pixels, as in "
      "V4R.",
      "ours; noise by Immerkaer 1996");
  v.num_threads(o.num_threads);
}

/// A frame and the data that all stages share, computed once.
struct PreparedView {
  RgbdFrame frame;
  OrganizedCloud cloud;  ///< With normals, camera frame.
  /// Distance to the nearest depth discontinuity in pixels, capped (see find_edge_distance()).
  Image<float> edge_distance_px;
  NoiseImages noise;                ///< Axial and lateral sigma in metres; NaN where there is no point.
  bool is_grey = false;             ///< is_grey() of the frame: colours are compared by lightness alone.
  Image<Rgb8> averaged_color = {};  ///< Over PrepareViewOptions::color_width_m; empty if off or with little noise.

  /// The colours to compare with those of a model.
  [[nodiscard]] const Image<Rgb8>& surface_color() const {
    return averaged_color.empty() ? frame.color : averaged_color;
  }
};

/// Divisor of width and height by which prepare_view() reduces views of this camera.
[[nodiscard]] int find_reduction(const Camera& camera, const PrepareViewOptions& options);

/// Computes cloud, normals, depth edges and noise of a frame (reduced if it is large: reduce_frame()), without what is
/// too near to be measured. Throws std::invalid_argument if check_frame() fails.
[[nodiscard]] PreparedView prepare_view(RgbdFrame frame, const PrepareViewOptions& options = {});

}  // namespace resight
