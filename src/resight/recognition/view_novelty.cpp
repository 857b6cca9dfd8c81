// SPDX-License-Identifier: Apache-2.0
#include "resight/recognition/view_novelty.hpp"

#include <cmath>
#include <optional>

#include "resight/core/check.hpp"
#include "resight/evidence/surface_evidence.hpp"

namespace resight {
namespace {

// A surface seen from a direction that differs more (15 deg) is searched again.
constexpr double kMaxRotation_rad = 0.26;
constexpr std::size_t kRememberedViews = 4;  // Searched views that a surface is compared with; bounds time and memory.
constexpr int kPixelStep = 4;                // Every fourth row and column is tested, for speed.
constexpr float kMinEdgeDistance_px = 3;     // Nearer to depth edges, measurements of the same surface vary.
constexpr DepthMargin kMargin{.base_m = 0.02, .noise_sigmas = 3};  // As in change detection.

// Whether one of the pixels around has the depth of the point.
bool was_measured(const Eigen::Vector3f& p, const Camera& camera, const Image<float>& depth_m) {
  const std::optional<Pixel> pixel = camera.pixel_of(p.cast<double>());
  if (!pixel) return false;
  const float tolerance_m = kMargin.at(p.z(), camera.noise);
  const auto [u, v] = *pixel;
  for (int dv = -1; dv <= 1; ++dv)
    for (int du = -1; du <= 1; ++du)
      if (depth_m.contains(u + du, v + dv) && std::abs(depth_m(u + du, v + dv) - p.z()) < tolerance_m) return true;
  return false;
}

}  // namespace

ViewNovelty::ViewNovelty(const SearchPlannerOptions& options) : options_((options.check(), options)) {}

bool ViewNovelty::needs_search(const PreparedView& view, const ChangeResult& changes) {
  if (!options_.max_new_share) return true;
  ++views_since_search_;
  const bool due = searched_.empty() || views_since_search_ == 0 || views_since_search_ >= options_.full_interval ||
                   changes.pose_suspect || shows_something_new(view, changes);
  if (!due) return false;
  views_since_search_ = 0;
  searched_.push_back({view.frame.camera, view.frame.world_from_camera, view.frame.depth_m});
  if (searched_.size() > kRememberedViews) searched_.pop_front();
  return true;
}

void ViewNovelty::forget_last_search() {
  if (!searched_.empty()) searched_.pop_back();
  request_search();
}

bool ViewNovelty::shows_something_new(const PreparedView& view, const ChangeResult& changes) const {
  const Rigid3f world_from_camera(view.frame.world_from_camera);
  const OrganizedCloud& cloud = view.cloud;
  require(view.edge_distance_px.size() == cloud.z.size(), "ViewNovelty: the view is not prepared");
  int num_seen = 0;
  int num_new = 0;
  for (int v = 0; v < cloud.height(); v += kPixelStep)
    for (int u = 0; u < cloud.width(); u += kPixelStep) {
      const std::size_t i = cloud.z.index(u, v);
      if (!cloud.has_point(i) || view.edge_distance_px[i] < kMinEdgeDistance_px) continue;
      ++num_seen;
      const bool novel = changes.novel_mask.size() > 0 && changes.novel_mask[i] != 0;
      if (novel || !was_searched(world_from_camera * cloud.point(i), world_from_camera.translation)) ++num_new;
    }
  return num_new > *options_.max_new_share * num_seen;
}

bool ViewNovelty::was_searched(const Eigen::Vector3f& p_in_world, const Eigen::Vector3f& eye_in_world) const {
  const Eigen::Vector3f ray = p_in_world - eye_in_world;
  const auto min_cosine = static_cast<float>(std::cos(kMaxRotation_rad));
  for (const SearchedView& searched : searched_) {
    const Rigid3f camera_from_world(searched.world_from_camera.inverse());
    const Eigen::Vector3f p = camera_from_world * p_in_world;
    if (!was_measured(p, searched.camera, searched.depth_m)) continue;
    const Eigen::Vector3f ray_then = p_in_world - searched.world_from_camera.translation.cast<float>();
    const float distance = ray.norm();
    if (ray.dot(ray_then) > min_cosine * distance * ray_then.norm() &&
        ray_then.norm() < static_cast<float>(kMaxDistanceRatio) * distance)
      return true;
  }
  return false;
}

}  // namespace resight
