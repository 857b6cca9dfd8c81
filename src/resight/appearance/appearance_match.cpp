// SPDX-License-Identifier: Apache-2.0
#include "resight/appearance/appearance_match.hpp"

#include <algorithm>
#include <cmath>

#include "resight/appearance/pattern_similarity.hpp"
#include "resight/core/check.hpp"

namespace resight {

PhotometricFit fit_photometry(const ColorPairs& pairs, const PhotometricLimits& limits) {
  return fit_photometry(pairs.model, pairs.scene, pairs.normals, limits);
}

std::vector<LabColor> adapt_colors(const ColorPairs& pairs, const PhotometricFit& fit) {
  std::vector<LabColor> adapted;
  adapted.reserve(pairs.size());
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const Eigen::Vector3f normal = pairs.normals.empty() ? Eigen::Vector3f::Zero().eval() : pairs.normals[i];
    adapted.push_back(to_lab(fit(pairs.model[i], normal)));  // No shading applies to a normal of zero.
  }
  return adapted;
}

int count_color_inliers(std::span<const LabColor> expected, std::span<const LabColor> seen, double min_similarity,
                        const AppearanceOptions& options) {
  require(expected.size() == seen.size(), "count_color_inliers: the colours differ in number");
  const ColorTolerance tolerance = color_tolerance(options);
  const auto max_exponent = static_cast<float>(-std::log(min_similarity));
  int count = 0;
  for (std::size_t i = 0; i < seen.size(); ++i)
    count += tolerance.exponent(expected[i], seen[i]) < max_exponent ? 1 : 0;
  return count;
}

TextureMatch match_texture(std::span<const LabColor> model, std::span<const LabColor> expected,
                           std::span<const LabColor> seen, const AppearanceOptions& options) {
  const PatternMatch match = match_patterns(expected, seen, options.chroma_weight);
  const double contrast = match_patterns(model, model, options.chroma_weight).shared_texture;
  return {match.similarity, std::min(match.shared_texture, contrast), contrast};
}

}  // namespace resight
