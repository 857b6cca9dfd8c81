// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <span>
#include <vector>

#include "resight/core/image.hpp"
#include "resight/core/options.hpp"

namespace resight {

/// Converts an sRGB colour to linear light, each channel in [0, 1].
[[nodiscard]] Eigen::Vector3f to_linear_light(Rgb8 color);
[[nodiscard]] std::vector<Eigen::Vector3f> to_linear_light(std::span<const Rgb8> colors);

/// Change of the colours of an object between training and scene, in linear light:
///   scene_c = model_c exp(log_gain_c + shading . n) + offset_c.
/// The model has one gain per channel (exposure, white balance), one brightness that depends on the normal n
/// (first-order spherical harmonics, Basri and Jacobs 2003, in the log domain), and one offset per channel (gloss,
/// glare, black level).
struct PhotometricFit {
  Eigen::Array3f log_gain = Eigen::Array3f::Zero();
  Eigen::Array3f offset = Eigen::Array3f::Zero();
  Eigen::Vector3f shading = Eigen::Vector3f::Zero();
  int num_pairs = 0;                                    ///< Number of colour pairs in the fit; 0 means the identity.
  Eigen::Array3f model_light = Eigen::Array3f::Ones();  ///< Mean linear light of the model, per channel; positive.

  [[nodiscard]] Eigen::Vector3f operator()(const Eigen::Vector3f& linear, const Eigen::Vector3f& normal) const {
    return (linear.array() * (log_gain + shading.dot(normal)).exp() + offset).min(1.0F).matrix();
  }
  /// Log gain of each channel relative to the mean of all channels.
  [[nodiscard]] Eigen::Array3f chroma() const { return log_gain - log_gain.mean(); }
};

/// Limits of a photometric fit. They prevent a black object from matching a white one, or a green one a grey one.
struct PhotometricLimits {
  double max_log_exposure = 0.9;
  double max_log_darkening = 0.9;
  double max_log_shading = 0.5;
  double max_offset = 0.08;
};

inline void declare(OptionVisitor& v, PhotometricLimits& o) {
  v.field("max_log_exposure", o.max_log_exposure, at_least(0),
          "Largest brightening: mean log gain of the channels, weighted by the model's light in them. 0.9: 2.5 times "
          "brighter; 0: none.");
  v.field("max_log_darkening", o.max_log_darkening, at_least(0), "Largest darkening (log), for objects in shadow.");
  v.field("max_log_shading", o.max_log_shading, at_least(0),
          "Largest change of the log brightness with the surface normal (light from one side). 0: none.",
          "Basri and Jacobs 2003");
  v.field("max_offset", o.max_offset, at_least(0),
          "Largest offset added to all channels by gloss or glare, as a share of white (linear light).");
}

/// Largest log gain of a channel relative to the mean of all channels, for the whole scene: 2700 K lamps to daylight.
inline constexpr double kMaxLogWhiteBalance = 0.6;
/// Largest log gain of a channel of one object relative to its exposure under the white balance of the scene: more is
/// another colour.
inline constexpr double kMaxLogChroma = 0.15;

/// Fits a photometric model by robust, iteratively reweighted least squares to pairs of a model colour and the scene
/// colour at the same place, both in linear light. Applies the limits except those on white balance and chroma; see
/// limit_chromaticity(). All spans must have the same length and all normals the same frame; empty normals exclude the
/// shading. Fewer than ten pairs give the identity.
[[nodiscard]] PhotometricFit fit_photometry(std::span<const Eigen::Vector3f> model_linear,
                                            std::span<const Eigen::Vector3f> scene_linear,
                                            std::span<const Eigen::Vector3f> normals, const PhotometricLimits& limits);

/// White balance that the fits of a scene agree on, as log gains: per channel the median of chroma(), weighted by
/// `votes` (one per fit, not negative), within kMaxLogWhiteBalance. Votes of objects that are dark in any channel
/// count less: a yellow object says little about blue light. A few additional votes are cast for no change, so that one
/// weak hypothesis alone cannot determine the result.
[[nodiscard]] Eigen::Array3f find_white_balance(std::span<const PhotometricFit> fits, std::span<const float> votes);

/// Limits the chroma of a fit to within kMaxLogChroma of the white balance of the scene.
[[nodiscard]] PhotometricFit limit_chromaticity(PhotometricFit fit, const Eigen::Array3f& white_balance);

}  // namespace resight
