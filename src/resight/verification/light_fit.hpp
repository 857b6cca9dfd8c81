// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <span>
#include <vector>

#include "resight/core/image.hpp"

namespace resight {

/// Linear light of an sRGB colour, each channel in [0, 1].
[[nodiscard]] Eigen::Vector3f to_linear_light(Rgb8 color);
[[nodiscard]] std::vector<Eigen::Vector3f> to_linear_light(std::span<const Rgb8> colors);

/// How the light on the scene differs from that of the training: per channel a factor (exposure, white balance), and
/// one factor of brightness that changes with the normal (first-order spherical harmonics, Basri and Jacobs 2003, in
/// the log domain): scene_c = model_c exp(log_gain_c + shading . n).
struct LightFit {
  Eigen::Array3f log_gain = Eigen::Array3f::Zero();
  Eigen::Vector3f shading = Eigen::Vector3f::Zero();

  [[nodiscard]] Eigen::Vector3f operator()(const Eigen::Vector3f& linear, const Eigen::Vector3f& normal) const {
    return (linear.array() * (log_gain + shading.dot(normal)).exp()).min(1.0F).matrix();
  }
};

/// What light may do. A black object never turns white, nor a green one grey.
struct LightLimits {
  double max_log_exposure = 0.9;  ///< Of the mean gain of the channels, either way (0.9: 2.5 times).
  double max_log_chroma = 0.25;   ///< Of a channel's gain beyond that mean (0.25: 1.28 times).
  double max_log_shading = 0.5;   ///< Length of `shading`.
};

/// Robust least squares (iteratively reweighted) over pairs of a model colour and the scene colour at the same place.
/// All spans of one length; normals in one frame, empty: no shading is fitted. Fewer than ten pairs: identity.
[[nodiscard]] LightFit fit_light(std::span<const Eigen::Vector3f> model_linear,
                                 std::span<const Eigen::Vector3f> scene_linear,
                                 std::span<const Eigen::Vector3f> normals, const LightLimits& limits);

}  // namespace resight
