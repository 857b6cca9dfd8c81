// SPDX-License-Identifier: Apache-2.0
#include "resight/verification/appearance_check.hpp"

#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

#include "resight/appearance/lab_color.hpp"
#include "resight/appearance/pattern_similarity.hpp"
#include "resight/appearance/photometric_fit.hpp"

namespace resight {
namespace {

constexpr std::size_t kMinPoints = 50;
constexpr float kMinProjectedDepth_m = 0.1F;

// Light of the model and of the view at the same places, and the normals there in the camera frame.
struct SeenPrint {
  std::vector<Eigen::Vector3f> model_light;
  std::vector<Eigen::Vector3f> seen_light;
  std::vector<Eigen::Vector3f> normals;
};

SeenPrint look_without_depth(const PointCloud& surface, const Rigid3f& camera_from_object, const RgbdFrame& frame) {
  SeenPrint print;
  for (std::size_t i = 0; i < surface.size(); ++i) {
    const Eigen::Vector3f p = camera_from_object * surface.points[i];
    const Eigen::Vector3f normal = camera_from_object.rotation * surface.normals[i];
    if (p.z() <= kMinProjectedDepth_m || normal.dot(p) >= 0) continue;
    const Eigen::Vector2d pixel = frame.camera.project(p.cast<double>());
    const int u = static_cast<int>(std::lround(pixel.x()));
    const int v = static_cast<int>(std::lround(pixel.y()));
    if (!frame.depth_m.contains(u, v) || frame.depth_m(u, v) > 0) continue;  // NaN is not
    print.model_light.push_back(to_linear_light(surface.colors[i]));
    print.seen_light.push_back(to_linear_light(frame.color(u, v)));
    print.normals.push_back(normal);
  }
  return print;
}

// Of the model as this light shows it and the view, the points whose colours agree.
std::size_t count_explained(std::span<const LabColor> expected, std::span<const LabColor> seen,
                            const VerifyOptions& options) {
  const ColorTolerance tolerance(options.appearance.sigma_l, options.appearance.sigma_ab);
  const auto max_exponent = static_cast<float>(-std::log(options.support.min_weight));
  std::size_t count = 0;
  for (std::size_t i = 0; i < seen.size(); ++i)
    count += tolerance.exponent(expected[i], seen[i]) <= max_exponent ? 1 : 0;
  return count;
}

}  // namespace

double color_confirmed_share(const ObjectModel& model, const Rigid3& world_from_object, const RgbdFrame& frame,
                             const VerifyOptions& options) {
  if (!options.appearance.use_color || frame.color.empty() || !model.surface.has_colors() ||
      !model.surface.has_normals())
    return 0;
  const SeenPrint view =
      look_without_depth(model.surface, Rigid3f(frame.world_from_camera.inverse() * world_from_object), frame);
  const std::size_t num_points = view.model_light.size();
  if (num_points < kMinPoints) return 0;
  const PhotometricFit light =
      limit_chromaticity(fit_photometry(view.model_light, view.seen_light, view.normals, options.appearance.light),
                         Eigen::Array3f::Zero());
  std::vector<LabColor> expected;
  for (std::size_t i = 0; i < num_points; ++i) expected.push_back(to_lab(light(view.model_light[i], view.normals[i])));
  const std::vector<LabColor> seen = to_lab(view.seen_light);
  const std::size_t num_explained = count_explained(expected, seen, options);
  if (static_cast<double>(num_explained) < options.acceptance.min_explained_share * static_cast<double>(num_points))
    return 0;
  const double chroma_weight = options.appearance.sigma_l / options.appearance.sigma_ab;
  const std::vector<LabColor> print = to_lab(view.model_light);
  const PatternMatch match = match_patterns(expected, seen, chroma_weight);
  const double shared_texture =  // What is plain has none for being round.
      std::min(match.shared_texture, match_patterns(print, print, chroma_weight).shared_texture);
  const AcceptanceOptions& acceptance = options.acceptance;
  if (acceptance.min_pattern_similarity && match.similarity < *acceptance.min_pattern_similarity) return 0;
  if (acceptance.untextured && shared_texture < acceptance.untextured->max_shared_contrast) return 0;
  return static_cast<double>(num_explained) / static_cast<double>(model.surface.size());
}

}  // namespace resight
