// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <span>
#include <vector>

#include "resight/appearance/appearance_options.hpp"
#include "resight/appearance/lab_color.hpp"
#include "resight/appearance/photometric_fit.hpp"

namespace resight {

/// Colours of a model and of the scene at the same places, in linear light, and the surface normals there.
struct ColorPairs {
  std::vector<Eigen::Vector3f> model = {};
  std::vector<Eigen::Vector3f> scene = {};
  std::vector<Eigen::Vector3f> normals = {};  ///< Unit, all in one frame; empty: not known.
  [[nodiscard]] std::size_t size() const { return model.size(); }
  [[nodiscard]] bool empty() const { return model.empty(); }
};

[[nodiscard]] PhotometricFit fit_photometry(const ColorPairs& pairs, const PhotometricLimits& limits);

/// The model's colours as the fitted light shows them; needs no colours of the scene.
[[nodiscard]] std::vector<LabColor> adapt_colors(const ColorPairs& pairs, const PhotometricFit& fit);

[[nodiscard]] inline ColorTolerance color_tolerance(const AppearanceOptions& options) {
  return {options.sigma_l, options.sigma_ab, options.sigma_saturation};
}

/// Number of places where the colours are more similar than `min_similarity` (exp(-ColorTolerance::exponent())).
/// `expected`: of the model under the light of the scene; both of one length.
[[nodiscard]] int count_color_inliers(std::span<const LabColor> expected, std::span<const LabColor> seen,
                                      double min_similarity, const AppearanceOptions& options);

/// TextureMatch::texture_contrast from which a model is textured.
inline constexpr double kMinTextureContrast = 1;

/// How well the texture of a model agrees with what is seen at the same places.
struct TextureMatch {
  double similarity = 1;        ///< PatternMatch::similarity.
  double shared_texture = 0;    ///< PatternMatch::shared_texture, but no more than the model's own texture_contrast:
                                ///< shading alone is no texture.
  double texture_contrast = 0;  ///< Of the model in even light.
};

/// `model`: its own colours; `expected`: these under the light of the scene. All of one length.
[[nodiscard]] TextureMatch match_texture(std::span<const LabColor> model, std::span<const LabColor> expected,
                                         std::span<const LabColor> seen, const AppearanceOptions& options);

}  // namespace resight
