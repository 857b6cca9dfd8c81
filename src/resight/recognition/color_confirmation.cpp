// SPDX-License-Identifier: Apache-2.0
#include "resight/recognition/color_confirmation.hpp"

#include <cmath>
#include <vector>

#include "resight/verification/lab_color.hpp"
#include "resight/verification/light_fit.hpp"
#include "resight/verification/pattern_similarity.hpp"

namespace resight {
namespace {

constexpr std::size_t kMinPoints = 50;
constexpr float kMinDepth_m = 0.1F;

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
    if (p.z() <= kMinDepth_m || normal.dot(p) >= 0) continue;
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

}  // namespace

double color_confirmed_share(const ObjectModel& model, const Rigid3& world_from_object, const RgbdFrame& frame,
                             const VerifyOptions& options) {
  if (frame.color.empty() || !model.surface.has_colors() || !model.surface.has_normals()) return 0;
  const SeenPrint seen =
      look_without_depth(model.surface, Rigid3f(frame.world_from_camera.inverse() * world_from_object), frame);
  if (seen.model_light.size() < kMinPoints) return 0;
  const LightFit light = fit_light(seen.model_light, seen.seen_light, seen.normals, options.light);
  std::vector<LabColor> expected;
  for (std::size_t i = 0; i < seen.model_light.size(); ++i)
    expected.push_back(to_lab(light(seen.model_light[i], seen.normals[i])));
  const PatternMatch match =
      match_patterns(expected, to_lab(seen.seen_light), options.color_sigma_l / options.color_sigma_ab);
  if (match.similarity < options.min_pattern_similarity || match.shared_contrast < options.plain.max_shared_contrast)
    return 0;
  return static_cast<double>(seen.model_light.size()) / static_cast<double>(model.surface.size());
}

}  // namespace resight
