// SPDX-License-Identifier: Apache-2.0
#include "resight/verification/visibility.hpp"

#include <algorithm>
#include <limits>
#include <utility>

#include "resight/core/check.hpp"
#include "resight/core/parallel.hpp"
#include "resight/evidence/fill_small_holes.hpp"

namespace resight {
namespace {

// What the views see of each model point, from the newest view back.
struct Seen {
  explicit Seen(std::size_t num_points)
      : best_facing(num_points, -1), num_views(num_points, 0), num_through(num_points, 0), newest(num_points) {}

  void add(const SurfaceEvidence& evidence) {
    for (std::size_t i = 0; i < evidence.points.size(); ++i) {
      if (!is_observed(evidence.points[i])) continue;
      if (num_views[i]++ == 0) newest[i] = evidence.points[i];
      num_through[i] += evidence.points[i] == Evidence::kSeenThrough ? 1 : 0;
      best_facing[i] = std::max(best_facing[i], evidence.viewing_cosine[i]);
    }
  }

  std::vector<float> best_facing;
  std::vector<int> num_views;
  std::vector<int> num_through;
  std::vector<Evidence> newest;  // Of the newest view that sees it.
};

}  // namespace

std::vector<DepthView> prepare_depth_views(std::span<const VerificationView> views, double min_edge_distance_px,
                                           int num_threads) {
  std::vector<DepthView> result(views.size());
  parallel_for(views.size(), num_threads, [&](std::size_t i) {
    const PreparedView& view = *views[i].view;
    result[i] = {view.frame.camera, view.frame.world_from_camera, &view.surface_color(),
                 fill_small_holes(view.frame.depth_m)};
    if (min_edge_distance_px == 0) return;
    require(view.edge_distance_px.size() == view.cloud.z.size(), "prepare_depth_views: a view without depth edges");
    Image<float>& depth_m = result[i].depth_m;
    for (std::size_t k = 0; k < depth_m.size(); ++k)
      if (view.edge_distance_px[k] < static_cast<float>(min_edge_distance_px))
        depth_m[k] = std::numeric_limits<float>::quiet_NaN();
  });
  return result;
}

ModelVisibility find_visible_points(std::span<const Eigen::Vector3f> points, std::span<const Eigen::Vector3f> normals,
                                    std::span<const DepthView> views, std::span<const std::uint8_t> allowed,
                                    const VisibilityOptions& options, double spacing_m) {
  const SurfaceEvidenceOptions evidence_options{.margin = {.base_m = options.margin_m, .noise_sigmas = 0},
                                                .min_viewing_cosine = kMinFacing,
                                                .self_occlusion_spacing_m = spacing_m};
  const auto* majority = std::get_if<MajorityFreeSpace>(&options.free_space);
  ModelVisibility result;
  result.evidence.resize(views.size());
  Seen seen(points.size());
  for (std::size_t v = views.size(); v-- > 0;) {
    if (allowed[v] == 0) continue;
    SurfaceEvidence evidence = classify_surface({points, normals}, views[v].world_from_camera.inverse(),
                                                {views[v].camera, views[v].depth_m}, evidence_options);
    seen.add(evidence);
    result.evidence[v] = std::move(evidence.points);
  }
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (seen.num_views[i] == 0) continue;
    result.visible.push_back(static_cast<int>(i));
    result.facing.push_back(seen.best_facing[i]);
    const bool through = majority != nullptr ? seen.num_through[i] > majority->max_share * seen.num_views[i]
                                             : seen.newest[i] == Evidence::kSeenThrough;
    result.seen_through.push_back(through ? 1 : 0);
  }
  return result;
}

}  // namespace resight
