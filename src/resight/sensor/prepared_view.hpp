// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "resight/sensor/depth_edges.hpp"
#include "resight/sensor/noise_model.hpp"
#include "resight/sensor/organized_cloud.hpp"
#include "resight/sensor/rgbd_frame.hpp"

namespace resight {

struct PrepareViewOptions {
  ComputeNormalsOptions normals = {};
  DepthEdgeOptions edges = {};
  double max_depth_m = 0;  ///< Farther points are dropped from cloud and noise ("chop z"); 0 keeps all. The frame's
                           ///< depth stays whole: what lies beyond is still evidence of free space, and no depth edge.
  int num_threads = 1;     ///< Of all steps (normals.num_threads is not used). Same bits for any value >= 1.
  void check() const;
};

/// A frame and the data that all stages share, computed once.
struct PreparedView {
  RgbdFrame frame;
  OrganizedCloud cloud;  ///< With normals, camera frame.
  /// Distance to the nearest depth discontinuity in pixels, capped (see find_edge_distance()).
  Image<float> edge_distance_px;
  NoiseImages noise;  ///< Axial and lateral sigma in metres; NaN where there is no point.
};

/// Computes cloud, normals, depth edges and noise of a frame. Throws std::invalid_argument if check_frame() fails.
[[nodiscard]] PreparedView prepare_view(RgbdFrame frame, const PrepareViewOptions& options = {});

}  // namespace resight
