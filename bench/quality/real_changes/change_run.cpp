// SPDX-License-Identifier: Apache-2.0
#include "change_run.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "resight/recognition/stage_options.hpp"

namespace resight::bench {
namespace {

constexpr double kMinDepth_m = 0.05;
constexpr double kSplatRadius_voxels = 0.6;

// The nearest depth counts where points overlap.
void keep_nearest(float z_m, float& depth_m) {
  if (!(depth_m <= z_m)) depth_m = z_m;
}

// Draws a point as a disc, and at least as its own pixel.
void splat(const Camera& camera, const Eigen::Vector3d& p_in_camera, double radius_m, Image<float>& depth_m) {
  const auto z_m = static_cast<float>(p_in_camera.z());
  const Eigen::Vector2d center_px = camera.project(p_in_camera);
  const double radius_px = radius_m * camera.fx / p_in_camera.z();
  const auto first = [](double from) { return std::max(0, static_cast<int>(std::ceil(std::max(from, 0.0)))); };
  const auto last = [](double to, int size) { return static_cast<int>(std::floor(std::min(to, size - 1.0))); };
  for (int v = first(center_px.y() - radius_px); v <= last(center_px.y() + radius_px, camera.height); ++v)
    for (int u = first(center_px.x() - radius_px); u <= last(center_px.x() + radius_px, camera.width); ++u)
      if ((Eigen::Vector2d(u, v) - center_px).norm() <= radius_px) keep_nearest(z_m, depth_m(u, v));
  if (const auto own = camera.pixel_at(center_px)) keep_nearest(z_m, depth_m(own->u, own->v));
}

DynamicSceneOptions options_with_changes(const RecognizerConfig& config) {
  DynamicSceneOptions options = scene_options(config);
  options.detect_changes = true;
  return options;
}

}  // namespace

ChangeRun::ChangeRun(const RecognizerConfig& config)
    : prepare_(config.prepare),
      voxel_m_(config.changes.detection.voxel_m),
      corrector_(correction_options(config)),
      scene_(options_with_changes(config)) {}

ChangeResult ChangeRun::add_view(RgbdFrame frame) {
  PreparedView view = prepare_view(std::move(frame), prepare_);
  const Rigid3 given = view.frame.world_from_camera;
  view.frame.world_from_camera = corrector_.add_view(view);
  if (view.frame.world_from_camera.matrix() != given.matrix()) ++num_corrected_;
  return scene_.add_view(std::move(view));
}

Image<float> ChangeRun::project_removed(const ChangeResult& changes) const {
  const Camera& camera = frame().camera;
  Image<float> depth_m(camera.width, camera.height, std::numeric_limits<float>::quiet_NaN());
  const Rigid3 camera_from_world = frame().world_from_camera.inverse();
  for (const Eigen::Vector3f& p_in_world : changes.removed_in_world.points) {
    const Eigen::Vector3d p_in_camera = camera_from_world * p_in_world.cast<double>().eval();
    if (p_in_camera.z() > kMinDepth_m) splat(camera, p_in_camera, kSplatRadius_voxels * voxel_m_, depth_m);
  }
  return depth_m;
}

}  // namespace resight::bench
