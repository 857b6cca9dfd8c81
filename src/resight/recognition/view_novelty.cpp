// SPDX-License-Identifier: Apache-2.0
#include "resight/recognition/view_novelty.hpp"

#include <cmath>
#include <numbers>
#include <optional>

#include "resight/core/check.hpp"
#include "resight/evidence/surface_evidence.hpp"

namespace resight {
namespace {

constexpr std::size_t kLooks = 4;
constexpr int kPixelStep = 4;
constexpr float kMinEdgeDistance_px = 3;  // Nearer to depth edges, the same surface is measured here and there.
constexpr DepthMargin kMargin{.base_m = 0.02, .noise_sigmas = 3};  // As of a change; far away, noise flickers.

// Whether one of the pixels around has the depth of the point.
bool was_measured(const Eigen::Vector3f& p, const Camera& camera, const Image<float>& depth_m) {
  const std::optional<Pixel> pixel = camera.pixel_of(p.cast<double>());
  if (!pixel) return false;
  const float tolerance_m = kMargin.at(p.z(), camera.fx);
  const auto [u, v] = *pixel;
  for (int dv = -1; dv <= 1; ++dv)
    for (int du = -1; du <= 1; ++du)
      if (depth_m.contains(u + du, v + dv) && std::abs(depth_m(u + du, v + dv) - p.z()) < tolerance_m) return true;
  return false;
}

}  // namespace

void AttentionOptions::check() const {
  check_in_range("AttentionOptions.max_unseen_share", max_unseen_share, 0, 1);
  check_positive("AttentionOptions.full_look_every", full_look_every);
  check_in_range("AttentionOptions.max_turn_rad", max_turn_rad, 0, std::numbers::pi);
  check_in_range("AttentionOptions.max_distance_ratio", max_distance_ratio, 1, 1000);
  check_positive("AttentionOptions.max_depth_m", max_depth_m);
  check_not_negative("AttentionOptions.object_look_every", object_look_every);
  check_positive("AttentionOptions.object_min_views", object_min_views);
  check_in_range("AttentionOptions.min_sure_share", min_sure_share, 0, 1);
}

ViewNovelty::ViewNovelty(const AttentionOptions& options) : options_((options.check(), options)) {}

bool ViewNovelty::needs_search(const PreparedView& view, const ChangeResult& changes) {
  if (options_.max_unseen_share <= 0) return true;
  ++views_since_look_;
  const bool due = looks_.empty() || views_since_look_ == 0 || views_since_look_ >= options_.full_look_every ||
                   changes.pose_suspect || shows_something_new(view, changes);
  if (!due) return false;
  views_since_look_ = 0;
  looks_.push_back({view.frame.camera, view.frame.world_from_camera, view.frame.depth_m});
  if (looks_.size() > kLooks) looks_.pop_front();
  return true;
}

bool ViewNovelty::shows_something_new(const PreparedView& view, const ChangeResult& changes) const {
  const Rigid3f world_from_camera(view.frame.world_from_camera);
  const OrganizedCloud& cloud = view.cloud;
  require(view.edge_distance_px.size() == cloud.z.size(), "Attention: the view is not prepared");
  int num_seen = 0;
  int num_new = 0;
  for (int v = 0; v < cloud.height(); v += kPixelStep)
    for (int u = 0; u < cloud.width(); u += kPixelStep) {
      const std::size_t i = cloud.z.index(u, v);
      if (!cloud.has_point(i) || cloud.z[i] > static_cast<float>(options_.max_depth_m) ||
          view.edge_distance_px[i] < kMinEdgeDistance_px)
        continue;
      ++num_seen;
      const bool novel = changes.novel_mask.size() > 0 && changes.novel_mask[i] != 0;
      if (novel || !was_searched(world_from_camera * cloud.point(i), world_from_camera.translation)) ++num_new;
    }
  return num_new > options_.max_unseen_share * num_seen;
}

bool ViewNovelty::was_searched(const Eigen::Vector3f& p_in_world, const Eigen::Vector3f& eye_in_world) const {
  const Eigen::Vector3f ray = p_in_world - eye_in_world;
  const auto min_cosine = static_cast<float>(std::cos(options_.max_turn_rad));
  for (const Look& look : looks_) {
    const Rigid3f camera_from_world(look.world_from_camera.inverse());
    const Eigen::Vector3f p = camera_from_world * p_in_world;
    if (!was_measured(p, look.camera, look.depth_m)) continue;
    const Eigen::Vector3f ray_then = p_in_world - look.world_from_camera.translation.cast<float>();
    const float distance = ray.norm();
    if (ray.dot(ray_then) > min_cosine * distance * ray_then.norm() &&
        ray_then.norm() < static_cast<float>(options_.max_distance_ratio) * distance)
      return true;
  }
  return false;
}

}  // namespace resight
