// SPDX-License-Identifier: Apache-2.0
#include "resight/verification/scene_association.hpp"

#include <algorithm>
#include <cmath>

#include "resight/appearance/pattern_similarity.hpp"
#include "resight/sensor/noise_model.hpp"

namespace resight {
SceneAssociation::SceneAssociation(const PreparedModel& model, const Rigid3& pose, const PreparedScene& scene,
                                   std::span<const DepthView> views, std::span<const std::uint8_t> allowed,
                                   const VerifyOptions& options)
    : world_from_object(pose), model_(&model), scene_(&scene), options_(&options) {
  const Rigid3f motion(pose);
  points.reserve(model.points.size());
  normals.reserve(model.normals.size());
  for (const Eigen::Vector3f& p : model.points) points.push_back(motion * p);
  for (const Eigen::Vector3f& n : model.normals) normals.push_back(motion.rotation * n);
  visibility = find_visible_points(points, normals, views, allowed, options.visibility, options.resolution_m);
  const auto* continuation = std::get_if<ContinuationClutter>(&options.clutter.rule);
  if (continuation != nullptr && continuation->noise_sigmas > 0) depth_noise_m = largest_depth_noise(views);
  if (!visibility.visible.empty()) compare_with_scene();
}

// Of the views that see it where it is, that of the farthest.
float SceneAssociation::largest_depth_noise(std::span<const DepthView> views) const {
  const Eigen::Vector3d center = world_from_object * model_->center.cast<double>().eval();
  double largest_m = 0;
  for (std::size_t v = 0; v < views.size(); ++v) {
    if (std::ranges::find(visibility.evidence[v], Evidence::kPresent) == visibility.evidence[v].end()) continue;
    const double depth_m = (views[v].world_from_camera.inverse() * center).z();
    if (depth_m > 0) largest_m = std::max(largest_m, axial_noise_m(views[v].camera.noise, depth_m));
  }
  return static_cast<float>(largest_m);
}

void SceneAssociation::compare_with_scene() {
  std::vector<Eigen::Vector3f> visible_points;
  visible_points.reserve(visibility.visible.size());
  for (const int i : visibility.visible) visible_points.push_back(points[static_cast<std::size_t>(i)]);
  const float inlier_distance = static_cast<float>(options_->support.max_distance_m);
  local.emplace(scene_->points, scene_->blocks, visible_points,
                inlier_distance + static_cast<float>(options_->clutter.radius_m), inlier_distance);
  if (!normals.empty() && !scene_->normals.empty()) local_normals = local->select(scene_->normals);
  if (!model_->linear_light.empty() && !scene_->linear_light.empty()) local_lab = local->select(scene_->lab);
  find_matches();
  fit_light_of_matches();
}

void SceneAssociation::find_matches() {
  matches.reserve(visibility.visible.size() * 24);
  for (std::size_t v = 0; v < visibility.visible.size(); ++v)
    local->visit_within(points[static_cast<std::size_t>(visibility.visible[v])],
                        static_cast<float>(options_->support.max_distance_m), [&](std::size_t q, float distance_sq) {
                          matches.push_back({static_cast<int>(v), static_cast<int>(q), distance_sq});
                          return true;
                        });
}

// From each visible point and its nearest scene point of similar normal.
void SceneAssociation::fit_light_of_matches() {
  const float min_dot = static_cast<float>(std::cos(kMaxInlierAngle_rad));
  for (std::size_t i = 0; i < matches.size();) {
    const PointMatch* best = nullptr;
    const int v = matches[i].visible;
    for (; i < matches.size() && matches[i].visible == v; ++i)
      if (normal_dot(matches[i]) >= min_dot && (best == nullptr || matches[i].distance_sq < best->distance_sq))
        best = &matches[i];
    if (best != nullptr) nearest.push_back(*best);
  }
  if (local_lab.empty()) return;
  for (const PointMatch& m : nearest) {
    const auto point = static_cast<std::size_t>(visibility.visible[static_cast<std::size_t>(m.visible)]);
    nearest_colors.model.push_back(model_->linear_light[point]);
    nearest_colors.scene.push_back(
        scene_->linear_light[static_cast<std::size_t>(local->scene_index(static_cast<std::size_t>(m.local)))]);
    if (!normals.empty()) nearest_colors.normals.push_back(normals[point]);
  }
  light = fit_photometry(nearest_colors, options_->appearance.light);
}

double SceneAssociation::color_fit() const {
  if (nearest.empty() || local_lab.empty()) return 0;
  const ColorTolerance tolerance = color_tolerance(options_->appearance);
  const std::vector<LabColor> expected =
      adapt_colors(nearest_colors, limit_chromaticity(light, Eigen::Array3f::Zero()));
  std::vector<LabColor> seen;
  double sum = 0;
  for (std::size_t k = 0; k < nearest.size(); ++k) {
    seen.push_back(local_lab[static_cast<std::size_t>(nearest[k].local)]);
    sum += std::exp(-tolerance.exponent(expected[k], seen[k]));
  }
  return sum / static_cast<double>(visibility.visible.size()) +
         pattern_similarity(expected, seen, options_->appearance.chroma_weight);
}

double SceneAssociation::supported_share() const {
  const float grazing_cosine = static_cast<float>(std::cos(kGrazingAngle_rad));
  const auto weight = [&](std::size_t v) { return visibility.facing[v] < grazing_cosine ? kGrazingWeight : 1.0; };
  double all = 0;
  for (std::size_t v = 0; v < visibility.visible.size(); ++v) all += weight(v);
  double supported = 0;
  for (const PointMatch& m : nearest) {
    const auto v = static_cast<std::size_t>(m.visible);
    if (visibility.seen_through[v] == 0) supported += weight(v);
  }
  return all > 0 ? supported / all : 0;
}

std::vector<int> find_roughly_visible(const PreparedModel& model, const Rigid3& world_from_object,
                                      std::span<const DepthView> views, std::span<const std::uint8_t> allowed,
                                      const VerifyOptions& options) {
  constexpr std::size_t kEnough = 2000;  // Refinement uses at most 300 of those that are visible.
  const std::size_t step = model.points.size() / kEnough + 1;
  const Rigid3f motion(world_from_object);
  std::vector<Eigen::Vector3f> points;
  std::vector<Eigen::Vector3f> normals;
  for (std::size_t i = 0; i < model.points.size(); i += step) {
    points.push_back(motion * model.points[i]);
    if (!model.normals.empty()) normals.push_back(motion.rotation * model.normals[i]);
  }
  const double spacing_m = options.resolution_m * std::sqrt(static_cast<double>(step));
  std::vector<int> visible =
      find_visible_points(points, normals, views, allowed, options.visibility, spacing_m).visible;
  for (int& i : visible) i *= static_cast<int>(step);
  return visible;
}

}  // namespace resight
