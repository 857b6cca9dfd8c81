// SPDX-License-Identifier: Apache-2.0
#include "resight/verification/newest_view_appearance.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "resight/verification/surface_blur.hpp"

namespace resight {
namespace {

constexpr std::ptrdiff_t kMinPointsInView = 50;  // Fewer colours do not determine a pattern.
constexpr double kMinShare = 0.1;  // Of the visible points: a small rest may lie at the rim of an occluder.

// The newest view in which enough of what is visible of the model is at the measured depth, or -1.
int find_newest(const ModelVisibility& visibility) {
  const auto enough = std::max(kMinPointsInView,
                               static_cast<std::ptrdiff_t>(kMinShare * static_cast<double>(visibility.visible.size())));
  for (int v = static_cast<int>(visibility.evidence.size()) - 1; v >= 0; --v)
    if (std::ranges::count(visibility.evidence[static_cast<std::size_t>(v)], Evidence::kPresent) >= enough) return v;
  return -1;
}

// Whether the camera sees the point at no grazing angle.
bool is_facing(const Eigen::Vector3f& point_in_camera, const Eigen::Vector3f& normal_in_camera) {
  constexpr float kMinCosine = 0.3F;
  return -point_in_camera.dot(normal_in_camera) > kMinCosine * point_in_camera.norm();
}

template <typename T, typename Test>
bool any_around(const Image<T>& image, const Pixel& pixel, int radius_px, const Test& test) {
  for (int v = std::max(0, pixel.v - radius_px); v <= std::min(image.height() - 1, pixel.v + radius_px); ++v)
    for (int u = std::max(0, pixel.u - radius_px); u <= std::min(image.width() - 1, pixel.u + radius_px); ++u)
      if (test(image(u, v))) return true;
  return false;
}

// Whether something before the point is measured near its pixel.
bool may_be_occluded(const Image<float>& depth_m, const Pixel& pixel, float z_m) {
  constexpr int kRadius_px = 6;
  constexpr float kMinDistance_m = 0.02F;
  return any_around(depth_m, pixel, kRadius_px, [&](float other_m) { return other_m < z_m - kMinDistance_m; });
}

// Whether no pixel around has the expected colour, and none is saturated: highlights tell nothing.
bool is_of_other_color(const Image<Rgb8>& color, const Pixel& pixel, const LabColor& expected,
                       const ColorTolerance& tolerance, float max_exponent) {
  constexpr int kRadius_px = 3;  // Poses and colours of real cameras are off by some pixels.
  constexpr int kSaturated = 250;
  return !any_around(color, pixel, kRadius_px, [&](const Rgb8& c) {
    return std::max({c.r, c.g, c.b}) >= kSaturated || tolerance.exponent(expected, to_lab(c)) <= max_exponent;
  });
}

}  // namespace

NewestViewAppearance::NewestViewAppearance(const PreparedModel& model, const SceneAssociation& association,
                                           std::span<const DepthView> views, const VerifyOptions& options)
    : options_(options) {
  const int newest = find_newest(association.visibility);
  if (newest < 0 || association.local_lab.empty()) return;
  const DepthView& view = views[static_cast<std::size_t>(newest)];
  const std::vector<Evidence>& evidence = association.visibility.evidence[static_cast<std::size_t>(newest)];
  const Rigid3f camera_from_world(view.world_from_camera.inverse());
  for (std::size_t i = 0; i < evidence.size(); ++i) {
    if (evidence[i] != Evidence::kPresent) continue;
    const std::optional<Pixel> pixel = view.camera.pixel_of((camera_from_world * association.points[i]).cast<double>());
    if (!pixel) continue;  // On the border, where rounding decides.
    points_.push_back(association.points[i]);
    colors_.model.push_back(model.linear_light[i]);
    colors_.scene.push_back(to_linear_light((*view.color)(pixel->u, pixel->v)));
    if (!association.normals.empty()) colors_.normals.push_back(association.normals[i]);
  }
  light_ = fit_photometry(colors_, options.appearance.light);
  add_unmeasured(model, association, view, evidence);
}

void NewestViewAppearance::add_unmeasured(const PreparedModel& model, const SceneAssociation& association,
                                          const DepthView& view, std::span<const Evidence> evidence) {
  if (association.normals.empty()) return;
  color_ = view.color;
  const Rigid3f camera_from_world(view.world_from_camera.inverse());
  for (std::size_t k = 0; k < evidence.size(); ++k) {
    if (evidence[k] != Evidence::kUnobserved) continue;
    const Eigen::Vector3f p = camera_from_world * association.points[k];
    if (!is_facing(p, camera_from_world.rotation * association.normals[k])) continue;
    const std::optional<Pixel> pixel = view.camera.pixel_of(p.cast<double>());
    if (!pixel || !std::isnan(view.depth_m(pixel->u, pixel->v)) || may_be_occluded(view.depth_m, *pixel, p.z()))
      continue;
    pixels_.push_back(*pixel);
    unmeasured_.model.push_back(model.linear_light[k]);
    unmeasured_.normals.push_back(association.normals[k]);
  }
}

double NewestViewAppearance::silhouette_error(const Eigen::Array3f& white_balance) const {
  if (colors_.empty() || pixels_.empty()) return 0;
  const std::vector<LabColor> expected = adapt_colors(unmeasured_, limit_chromaticity(light_, white_balance));
  const ColorTolerance tolerance = color_tolerance(options_.appearance);
  const float max_exponent = -std::log(static_cast<float>(options_.support.min_weight));
  int num_other = 0;
  for (std::size_t k = 0; k < pixels_.size(); ++k)
    num_other += is_of_other_color(*color_, pixels_[k], expected[k], tolerance, max_exponent) ? 1 : 0;
  return static_cast<double>(num_other) / static_cast<double>(pixels_.size() + colors_.size());
}

double NewestViewAppearance::similarity(const Eigen::Array3f& white_balance) const {
  if (colors_.empty()) return 1;
  const std::vector<LabColor> expected = adapt_colors(colors_, limit_chromaticity(light_, white_balance));
  return match_surface_texture(points_, to_lab(colors_.model), expected, to_lab(colors_.scene), options_.appearance)
      .similarity;
}

}  // namespace resight
