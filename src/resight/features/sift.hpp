// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "resight/features/feature_set.hpp"
#include "resight/sensor/prepared_view.hpp"

namespace resight {

struct SiftOptions {
  double contrast_threshold = 0.03;  ///< OpenCV's convention; the paper's code uses 0.03.
  double edge_threshold = 10.0;
  int num_octave_layers = 3;
  bool root_sift = false;  ///< Arandjelovic & Zisserman 2012: L1-normalise, then square root. Presets decide.
  void check() const;
};

/// Computes SIFT (Lowe 2004, by OpenCV, without its shift of a quarter pixel) at the DoG keypoints of the grey image.
/// Keypoints need depth and a normal at the nearest pixel (and a non-zero `mask` there, if given; size of the camera
/// image). A point lies on the ray of its sub-pixel position, at the depth of the nearest pixel. Camera frame; in order
/// of v, then u.
[[nodiscard]] FeatureSet extract_sift(const PreparedView& view, const SiftOptions& options = {},
                                      const Image<std::uint8_t>* mask = nullptr);

}  // namespace resight
