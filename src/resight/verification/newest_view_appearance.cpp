// SPDX-License-Identifier: Apache-2.0
#include "resight/verification/newest_view_appearance.hpp"

#include <algorithm>
#include <cmath>

#include "resight/appearance/pattern_similarity.hpp"

namespace resight {
namespace {

constexpr std::ptrdiff_t kMinPointsInView = 50;
constexpr double kMinShare = 0.1;

// The newest view in which enough of what is visible of the model is at the measured depth, or -1.
int find_newest(const ModelVisibility& visibility) {
  const auto enough = std::max(kMinPointsInView,
                               static_cast<std::ptrdiff_t>(kMinShare * static_cast<double>(visibility.visible.size())));
  for (int v = static_cast<int>(visibility.sight.size()) - 1; v >= 0; --v)
    if (std::ranges::count(visibility.sight[static_cast<std::size_t>(v)], Sight::kConsistent) >= enough) return v;
  return -1;
}

}  // namespace

NewestViewAppearance::NewestViewAppearance(const PreparedModel& model, const SceneAssociation& look,
                                           std::span<const DepthView> views, const VerifyOptions& options)
    : options_(options) {
  const int newest = find_newest(look.visibility);
  if (newest < 0 || look.local_lab.empty()) return;
  const DepthView& view = views[static_cast<std::size_t>(newest)];
  if (view.color == nullptr) return;
  const std::vector<Sight>& sight = look.visibility.sight[static_cast<std::size_t>(newest)];
  const Rigid3f camera_from_world(view.world_from_camera.inverse());
  for (std::size_t i = 0; i < sight.size(); ++i) {
    if (sight[i] != Sight::kConsistent) continue;
    const Eigen::Vector2d pixel = view.camera.project((camera_from_world * look.points[i]).cast<double>());
    const int u = std::clamp(static_cast<int>(std::lround(pixel.x())), 0, view.camera.width - 1);
    const int v = std::clamp(static_cast<int>(std::lround(pixel.y())), 0, view.camera.height - 1);
    model_light_.push_back(model.linear_light[i]);
    seen_light_.push_back(to_linear_light((*view.color)(u, v)));
    if (!look.normals.empty()) normals_.push_back(look.normals[i]);
  }
  light_ = fit_photometry(model_light_, seen_light_, normals_, options.appearance.light);
}

double NewestViewAppearance::similarity(const Eigen::Array3f& white_balance) const {
  if (model_light_.empty()) return 1;
  const PhotometricFit light = limit_chromaticity(light_, white_balance);
  std::vector<LabColor> expected;
  for (std::size_t i = 0; i < model_light_.size(); ++i)
    expected.push_back(to_lab(light(model_light_[i], normal_at(normals_, i))));
  return pattern_similarity(expected, to_lab(seen_light_), options_.appearance.sigma_l / options_.appearance.sigma_ab);
}

}  // namespace resight
