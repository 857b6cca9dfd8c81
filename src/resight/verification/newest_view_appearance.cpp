// SPDX-License-Identifier: Apache-2.0
#include "resight/verification/newest_view_appearance.hpp"

#include <algorithm>
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

}  // namespace

NewestViewAppearance::NewestViewAppearance(const PreparedModel& model, const SceneAssociation& association,
                                           std::span<const DepthView> views, const VerifyOptions& options)
    : options_(options) {
  const int newest = find_newest(association.visibility);
  if (newest < 0 || association.local_lab.empty()) return;
  const DepthView& view = views[static_cast<std::size_t>(newest)];
  if (view.color == nullptr) return;
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
}

double NewestViewAppearance::similarity(const Eigen::Array3f& white_balance) const {
  if (colors_.empty()) return 1;
  const std::vector<LabColor> expected = adapt_colors(colors_, limit_chromaticity(light_, white_balance));
  return match_surface_texture(points_, to_lab(colors_.model), expected, to_lab(colors_.scene), options_.appearance)
      .similarity;
}

}  // namespace resight
