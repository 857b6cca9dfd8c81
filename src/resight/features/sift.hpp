// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "resight/core/options.hpp"
#include "resight/features/feature_set.hpp"
#include "resight/sensor/prepared_view.hpp"

namespace resight {

struct SiftOptions {
  double contrast_threshold = 0.03;
  double edge_threshold = 10.0;
  int num_octave_layers = 3;
  bool root_sift = false;
  void check() const { check_options("SiftOptions", *this); }
};

inline void declare(OptionVisitor& v, SiftOptions& o) {
  v.field("contrast_threshold", o.contrast_threshold, at_least(0),
          "Keypoints of less contrast are dropped (convention of OpenCV). 0: none is.", "V4R");
  v.field("edge_threshold", o.edge_threshold, positive(),
          "Largest ratio of the principal curvatures of a keypoint. Smaller: fewer keypoints on edges.", "OpenCV");
  v.field("num_octave_layers", o.num_octave_layers, between(1, 20), "Scales per octave.", "Lowe 2004");
  v.field("root_sift", o.root_sift, "Descriptors are L1-normalised and square-rooted.",
          "Arandjelovic and Zisserman 2012");
}

/// Computes SIFT (Lowe 2004, by OpenCV, without its shift of a quarter pixel) at the DoG keypoints of the grey image.
/// Keypoints need depth and a normal at the nearest pixel (and a non-zero `mask` there, if given; size of the camera
/// image). A point lies on the ray of its sub-pixel position, at the depth of the nearest pixel. Camera frame; in order
/// of v, then u.
[[nodiscard]] FeatureSet extract_sift(const PreparedView& view, const SiftOptions& options = {},
                                      const Image<std::uint8_t>* mask = nullptr);

}  // namespace resight
