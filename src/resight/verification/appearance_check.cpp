// SPDX-License-Identifier: Apache-2.0
#include "resight/verification/appearance_check.hpp"

#include <cmath>
#include <optional>
#include <vector>

#include "resight/appearance/appearance_match.hpp"

namespace resight {
namespace {

constexpr std::size_t kMinPoints = 50;        // Fewer colours do not determine a pattern.
constexpr float kMinProjectedDepth_m = 0.1F;  // Nearer points are beside or behind the camera.

// Colours of the model and of the view where the view has no depth; normals in the camera frame.
ColorPairs pair_colors_without_depth(const PointCloud& surface, const Rigid3f& camera_from_object,
                                     const RgbdFrame& frame) {
  const bool as_grey = is_grey(frame.color);
  ColorPairs colors;
  for (std::size_t i = 0; i < surface.size(); ++i) {
    const Eigen::Vector3f p = camera_from_object * surface.points[i];
    const Eigen::Vector3f normal = camera_from_object.rotation * surface.normals[i];
    if (p.z() <= kMinProjectedDepth_m || normal.dot(p) >= 0) continue;
    const std::optional<Pixel> pixel = frame.camera.pixel_of(p.cast<double>());
    if (!pixel || !std::isnan(frame.depth_m(pixel->u, pixel->v))) continue;
    colors.model.push_back(to_linear_light(as_grey ? to_grey(surface.colors[i]) : surface.colors[i]));
    colors.scene.push_back(to_linear_light(frame.color(pixel->u, pixel->v)));
    colors.normals.push_back(normal);
  }
  return colors;
}

}  // namespace

double color_confirmed_share(const ObjectModel& model, const Rigid3& world_from_object, const RgbdFrame& frame,
                             const VerifyOptions& options) {
  if (!options.appearance.use_color || !model.surface.has_colors() || !model.surface.has_normals()) return 0;
  const ColorPairs colors =
      pair_colors_without_depth(model.surface, Rigid3f(frame.world_from_camera.inverse() * world_from_object), frame);
  if (colors.size() < kMinPoints) return 0;
  const PhotometricFit light =
      limit_chromaticity(fit_photometry(colors, options.appearance.light), Eigen::Array3f::Zero());
  const std::vector<LabColor> expected = adapt_colors(colors, light);
  const std::vector<LabColor> seen = to_lab(colors.scene);
  const double num_explained = count_color_inliers(expected, seen, options.support.min_weight, options.appearance);
  if (num_explained < options.acceptance.min_explained_share * static_cast<double>(colors.size())) return 0;
  const TextureMatch match = match_texture(to_lab(colors.model), expected, seen, options.appearance);
  const auto& min_similarity = options.acceptance.min_pattern_similarity;
  if (match.shared_texture < kMinTextureContrast) return 0;  // Many things have its colour.
  if (min_similarity && match.similarity < *min_similarity) return 0;
  return num_explained / static_cast<double>(model.surface.size());
}

}  // namespace resight
