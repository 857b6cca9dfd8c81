// SPDX-License-Identifier: Apache-2.0
#include "resight/changes/change_detector.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "resight/changes/view_difference.hpp"
#include "resight/core/check.hpp"
#include "resight/core/parallel.hpp"
#include "resight/geometry/spherical_bins.hpp"
#include "resight/geometry/view_frustum.hpp"

namespace resight {
namespace {

using Points = std::vector<Eigen::Vector3f>;
constexpr std::size_t kGrain = 4096;

/// The measurements of a view without the gaps.
Points collect_points(const OrganizedCloud& cloud) {
  Points in_camera;
  in_camera.reserve(cloud.z.size());
  for (std::size_t i = 0; i < cloud.z.size(); ++i)
    if (cloud.has_point(i)) in_camera.push_back(cloud.point(i));
  return in_camera;
}

Points transform_points(const Rigid3& a_from_b, const Points& points_in_b, int num_threads) {
  const Rigid3f motion(a_from_b);
  Points points_in_a(points_in_b.size());
  parallel_for_blocks(points_in_b.size(), kGrain, num_threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) points_in_a[i] = motion * points_in_b[i];
  });
  return points_in_a;
}

FrustumLimits view_volume(const Camera& camera, const DetectChangesOptions& options) {
  return ViewFrustum{camera, options.min_depth_m, options.max_depth_m, options.frustum_margin_rad}.limits();
}

/// What a view says about points in its camera frame.
std::vector<Evidence> classify_in_view(const Points& points_in_camera, const PreparedView& view,
                                       const DetectChangesOptions& options) {
  return classify_surface({.points = points_in_camera}, Rigid3::identity(), {view.frame.camera, view.frame.depth_m},
                          {.margin = {options.occlusion_margin_m, options.occlusion_sigmas},
                           .window_radius_px = options.window_radius_px,
                           .num_threads = options.num_threads})
      .points;
}

Tolerance tolerance_of(const Camera& camera, const DetectChangesOptions& options) {
  return {options.tolerance_m, options.tolerance_sigmas, camera.fx};
}

/// The points of Psi in the view volume that nothing of the view explains.
struct Unexplained {
  std::vector<int> indices;
  Points in_camera;
};

/// What the view says about points of the past that nothing of it explains.
std::vector<Evidence> judge_unexplained(const Points& queries_in_camera, const PreparedView& view,
                                        const DetectChangesOptions& options) {
  if (options.occlusion_test == OcclusionTest::kDepthImage) return classify_in_view(queries_in_camera, view, options);
  const DepthImage image{view.frame.camera, view.frame.depth_m};
  std::vector<Evidence> evidence =
      classify_occlusion(queries_in_camera, collect_points(view.cloud), SphericalBins(options.bin_size_rad),
                         options.occlusion_margin_m, options.num_threads);
  if (!options.require_return) return evidence;
  for (std::size_t i = 0; i < evidence.size(); ++i) {
    if (evidence[i] == Evidence::kSeenThrough &&
        std::isnan(nearest_depth(queries_in_camera[i], image, options.window_radius_px)))
      evidence[i] = Evidence::kUnobserved;
  }
  return evidence;
}

/// Alg. 1, lines 1 to 3, for every point of Psi. `explained_pixels`: see find_explained_points().
std::vector<Evidence> judge_previous(const Points& psi_in_camera, const PreparedView& view,
                                     const DetectChangesOptions& options, Image<std::uint8_t>* explained_pixels) {
  const Camera& camera = view.frame.camera;
  const std::vector<std::uint8_t> explained = find_explained_points(
      psi_in_camera, view.cloud, camera, tolerance_of(camera, options), options.num_threads, explained_pixels);
  const FrustumLimits volume = view_volume(camera, options);
  std::vector<Evidence> evidence(psi_in_camera.size(), Evidence::kPresent);
  Unexplained open;
  for (std::size_t i = 0; i < evidence.size(); ++i) {
    if (explained[i] != 0) continue;
    evidence[i] = Evidence::kUnobserved;
    if (!volume.contains(psi_in_camera[i])) continue;
    open.indices.push_back(static_cast<int>(i));
    open.in_camera.push_back(psi_in_camera[i]);
  }
  const std::vector<Evidence> judged = judge_unexplained(open.in_camera, view, options);
  for (std::size_t i = 0; i < open.indices.size(); ++i) evidence[static_cast<std::size_t>(open.indices[i])] = judged[i];
  return evidence;
}

/// Which of these pixels of the view an earlier view saw through.
std::vector<std::uint8_t> find_seen_through(const std::vector<int>& pixels, const PreparedView& view,
                                            const PreparedView& earlier, const DetectChangesOptions& options) {
  const Rigid3f earlier_from_view(earlier.frame.world_from_camera.inverse() * view.frame.world_from_camera);
  const FrustumLimits volume = view_volume(earlier.frame.camera, options);
  std::vector<int> positions;
  Points queries;
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    const Eigen::Vector3f p = earlier_from_view * view.cloud.point(static_cast<std::size_t>(pixels[i]));
    if (!volume.contains(p)) continue;
    positions.push_back(static_cast<int>(i));
    queries.push_back(p);
  }
  const std::vector<Evidence> evidence = classify_in_view(queries, earlier, options);
  std::vector<std::uint8_t> seen_through(pixels.size());
  for (std::size_t i = 0; i < positions.size(); ++i)
    seen_through[static_cast<std::size_t>(positions[i])] = evidence[i] == Evidence::kSeenThrough ? 1 : 0;
  return seen_through;
}

/// Of the novel pixels, those whose place an earlier view saw empty (see detect_changes()).
std::vector<int> keep_seen_through(const std::vector<int>& novel, const PreparedView& view,
                                   std::span<const PreparedView* const> earlier_views,
                                   const DetectChangesOptions& options) {
  std::vector<int> kept;
  std::vector<int> open = novel;  // not yet seen through
  for (const PreparedView* earlier : earlier_views) {
    const std::vector<std::uint8_t> seen_through = find_seen_through(open, view, *earlier, options);
    std::vector<int> still_open;
    for (std::size_t i = 0; i < open.size(); ++i) (seen_through[i] != 0 ? kept : still_open).push_back(open[i]);
    open = std::move(still_open);
  }
  std::sort(kept.begin(), kept.end());
  return kept;
}

double share(std::size_t part, std::size_t rest) {
  return part == 0 ? 0.0 : static_cast<double>(part) / static_cast<double>(part + rest);
}

PointCloud cloud_of_pixels(const std::vector<int>& pixels, const PreparedView& view) {
  const Rigid3f world_from_camera(view.frame.world_from_camera);
  PointCloud cloud_in_world;
  for (const int i : pixels) {
    cloud_in_world.points.push_back(world_from_camera * view.cloud.point(static_cast<std::size_t>(i)));
    cloud_in_world.colors.push_back(view.frame.color[static_cast<std::size_t>(i)]);
  }
  return cloud_in_world;
}

void check_views(const PreparedView& view, std::span<const PreparedView* const> earlier_views) {
  const auto is_consistent = [](const PreparedView& v) {
    const Camera& camera = v.frame.camera;
    const auto has_size = [&](const auto& image) {
      return image.width() == camera.width && image.height() == camera.height;
    };
    return camera.is_valid() && has_size(v.frame.depth_m) && has_size(v.frame.color) && has_size(v.cloud.z);
  };
  require(is_consistent(view), "detect_changes: the view's images have not its camera's size");
  for (const PreparedView* earlier : earlier_views)
    require(earlier != nullptr && is_consistent(*earlier),
            "detect_changes: an earlier view is null or its images have not its camera's size");
}

}  // namespace

ChangeResult detect_changes(const PointCloud& previous_in_world, const PreparedView& view,
                            const DetectChangesOptions& options, std::span<const PreparedView* const> earlier_views,
                            double previous_voxel_m) {
  options.check();
  check_views(view, earlier_views);
  if (!options.novel_needs_free_space) earlier_views = {};
  ChangeResult result;
  result.novel_mask = Image<std::uint8_t>(view.cloud.width(), view.cloud.height());
  if (previous_in_world.empty()) return result;

  // All in the camera frame: moving Psi there is cheaper than moving the view's points to the world.
  const bool thin = previous_voxel_m == options.voxel_m || is_downsampled(previous_in_world, options.voxel_m);
  const PointCloud downsampled = thin ? PointCloud{} : voxel_downsample(previous_in_world, options.voxel_m);
  const PointCloud& psi_in_world = thin ? previous_in_world : downsampled;
  const Rigid3 camera_from_world = view.frame.world_from_camera.inverse();
  const Points psi_in_camera = transform_points(camera_from_world, psi_in_world.points, options.num_threads);

  Image<std::uint8_t> explained_pixels(view.cloud.width(), view.cloud.height());
  const std::vector<Evidence> evidence =
      judge_previous(psi_in_camera, view, options, thin ? &explained_pixels : nullptr);
  std::vector<int> removed;
  for (std::size_t i = 0; i < evidence.size(); ++i) {
    ++result.evidence_count[static_cast<std::size_t>(evidence[i])];
    if (evidence[i] == Evidence::kSeenThrough) removed.push_back(static_cast<int>(i));
  }
  result.changed_share = share(removed.size(), result.evidence_count[static_cast<std::size_t>(Evidence::kPresent)]);

  const Points dense_psi =
      thin ? Points{} : transform_points(camera_from_world, previous_in_world.points, options.num_threads);
  std::vector<int> novel =
      find_unexplained_pixels(thin ? psi_in_camera : dense_psi, view.cloud, view.frame.camera,
                              tolerance_of(view.frame.camera, options), options.num_threads, explained_pixels);
  const std::size_t num_explained = count_valid(view.cloud.z) - novel.size();
  if (!earlier_views.empty()) novel = keep_seen_through(novel, view, earlier_views, options);
  result.novel_share = share(novel.size(), num_explained);

  // Without earlier views a large share of N may only mean that the camera looks at something else.
  result.pose_suspect = result.changed_share > options.max_changed_share ||
                        (!earlier_views.empty() && result.novel_share > options.max_changed_share);
  if (result.pose_suspect) return result;
  result.removed_in_world = select(psi_in_world, removed);
  result.novel_in_world = voxel_downsample(cloud_of_pixels(novel, view), options.voxel_m);
  for (const int i : novel) result.novel_mask[static_cast<std::size_t>(i)] = 1;
  return result;
}

}  // namespace resight
