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

/// What the light does to the colours of an object between training and scene, in linear light:
///   scene_c = model_c exp(log_gain_c + shading . n) + veil_c.
/// A gain a channel (exposure, white balance), one brightness that changes with the normal (first-order spherical
/// harmonics, Basri and Jacobs 2003, in the log domain), and a veil (gloss, glare, a black level that is none).
struct PhotometricFit {
  Eigen::Array3f log_gain = Eigen::Array3f::Zero();
  Eigen::Array3f offset = Eigen::Array3f::Zero();
  Eigen::Vector3f shading = Eigen::Vector3f::Zero();
  int num_pairs = 0;        ///< That it was fitted to; 0: the identity.
  float dimmest_light = 0;  ///< Of the model in its dimmest channel, mean over the pairs, linear.

  [[nodiscard]] Eigen::Vector3f operator()(const Eigen::Vector3f& linear, const Eigen::Vector3f& normal) const {
    return (linear.array() * (log_gain + shading.dot(normal)).exp() + offset).min(1.0F).matrix();
  }
  /// Gain of each channel beyond the mean of all, log.
  [[nodiscard]] Eigen::Array3f chroma() const { return log_gain - log_gain.mean(); }
};

/// What light may do. A black object never turns white, nor a green one grey.
struct PhotometricLimits {
  double max_log_exposure = 0.9;       ///< Of the mean gain of the channels (0.9: 2.5 times brighter)...
  double max_log_darkening = 0.9;      ///< ...and of its inverse: what stands in the shade.
  double max_log_white_balance = 0.6;  ///< Of a channel's gain beyond that mean, for the scene as a whole...
  double max_log_chroma = 0.15;        ///< ...and of one object beside the scene's white balance.
  double max_log_shading = 0.5;        ///< Length of `shading`.
  double max_offset = 0.08;            ///< Of 1, the white of the image.
};

/// Robust least squares (iteratively reweighted) over pairs of a model colour and the scene colour at the same place;
/// the limits hold but for the chroma's. All spans of one length; normals in one frame, empty: no shading is fitted.
/// Fewer than ten pairs: identity.
[[nodiscard]] PhotometricFit fit_photometry(std::span<const Eigen::Vector3f> model_linear,
                                            std::span<const Eigen::Vector3f> scene_linear,
                                            std::span<const Eigen::Vector3f> normals, const PhotometricLimits& limits);

/// The white balance that the fits of a scene agree on: per channel the median of chroma() by their votes (one each,
/// not negative), within its limit. The vote of what hardly shines in a channel counts less: a yellow object does not
/// tell how blue the light is. A few votes for none are among them: one weak hypothesis alone cannot set it.
[[nodiscard]] Eigen::Array3f find_white_balance(std::span<const PhotometricFit> fits, std::span<const float> votes,
                                                const PhotometricLimits& limits);

/// The fit with its chroma held to within max_log_chroma of the scene's.
[[nodiscard]] PhotometricFit limit_chromaticity(PhotometricFit fit, const Eigen::Array3f& white_balance,
                                                const PhotometricLimits& limits);

}  // namespace resight
