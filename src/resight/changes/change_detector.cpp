// SPDX-License-Identifier: Apache-2.0
#include "resight/changes/change_detector.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "resight/changes/difference.hpp"
#include "resight/core/check.hpp"
#include "resight/core/parallel.hpp"
#include "resight/geometry/spherical_bins.hpp"
#include "resight/geometry/view_frustum.hpp"
#include "resight/geometry/voxel_map.hpp"
#include "resight/sensor/noise_model.hpp"

namespace resight {
namespace {

using Points = std::vector<Eigen::Vector3f>;
constexpr std::size_t kGrain = 4096;

/// The measurements of a view without the gaps; `pixels` tells where each came from.
struct ViewPoints {
  Points in_camera;
  std::vector<int> pixels;
};

ViewPoints collect_points(const OrganizedCloud& cloud) {
  ViewPoints result;
  result.in_camera.reserve(cloud.z.size());
  result.pixels.reserve(cloud.z.size());
  for (std::size_t i = 0; i < cloud.z.size(); ++i) {
    if (!cloud.has_point(i)) continue;
    result.in_camera.push_back(cloud.point(i));
    result.pixels.push_back(static_cast<int>(i));
  }
  return result;
}

Points transform_points(const Rigid3& a_from_b, const Points& points_in_b) {
  const Rigid3f motion(a_from_b);
  Points points_in_a;
  points_in_a.reserve(points_in_b.size());
  for (const Eigen::Vector3f& p : points_in_b) points_in_a.push_back(motion * p);
  return points_in_a;
}

FrustumLimits view_volume(const Camera& camera, const DetectChangesOptions& options) {
  return ViewFrustum{camera, options.min_depth_m, options.max_depth_m, options.frustum_margin_rad}.limits();
}

DepthEvidenceOptions depth_options(const DetectChangesOptions& options) {
  return {options.window_radius_px, options.occlusion_margin_m, options.occlusion_sigmas, options.num_threads};
}

/// Eq. (2): positions of the points that no point of the grid explains.
std::vector<int> find_unexplained(const Points& points_in_camera, const ProximityGrid& grid, double focal_px,
                                  const DetectChangesOptions& options) {
  std::vector<std::uint8_t> explained(points_in_camera.size());
  parallel_for_blocks(points_in_camera.size(), kGrain, options.num_threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const Eigen::Vector3f& p = points_in_camera[i];
      bool near = grid.any_within(p);
      if (!near && options.tolerance_sigmas > 0 && p.z() > 0) {
        // Two measurements of one surface, each with its own noise: their difference has sqrt(2) times as much.
        const double sigma_m = std::numbers::sqrt2 * nguyen_noise(p.z(), 0, focal_px).axial_m;
        const double wider_m = options.tolerance_sigmas * sigma_m;
        near = wider_m > options.tolerance_m && grid.any_within(p, wider_m);
      }
      explained[i] = near ? 1 : 0;
    }
  });
  std::vector<int> indices;
  for (std::size_t i = 0; i < explained.size(); ++i)
    if (explained[i] == 0) indices.push_back(static_cast<int>(i));
  return indices;
}

Points select_points(const Points& points, std::span<const int> indices) {
  Points selected;
  selected.reserve(indices.size());
  for (const int i : indices) selected.push_back(points[i]);
  return selected;
}

/// What the view says about points of the past that nothing of it explains.
std::vector<Evidence> judge_unexplained(const Points& queries_in_camera, const PreparedView& view,
                                        const Points& view_points_in_camera, const DetectChangesOptions& options) {
  const Camera& camera = view.frame.camera;
  if (options.occlusion_test == OcclusionTest::kDepthImage)
    return classify_against_depth(queries_in_camera, camera, view.frame.depth_m, depth_options(options));
  std::vector<Evidence> evidence =
      classify_occlusion(queries_in_camera, view_points_in_camera, SphericalBins(options.bin_size_rad),
                         options.occlusion_margin_m, options.num_threads);
  if (!options.require_return) return evidence;
  for (std::size_t i = 0; i < evidence.size(); ++i) {
    if (evidence[i] == Evidence::kSeenThrough &&
        std::isnan(nearest_depth(queries_in_camera[i], camera, view.frame.depth_m, options.window_radius_px)))
      evidence[i] = Evidence::kUnobserved;
  }
  return evidence;
}

/// Alg. 1, lines 1 to 3, for every point of Psi.
std::vector<Evidence> judge_previous(const Points& previous_in_camera, const PreparedView& view,
                                     const Points& view_points_in_camera, const DetectChangesOptions& options) {
  const ProximityGrid grid(view_points_in_camera, options.tolerance_m);
  const std::vector<int> unexplained = find_unexplained(previous_in_camera, grid, view.frame.camera.fx, options);
  const Points queries = select_points(previous_in_camera, unexplained);
  const std::vector<Evidence> judged = judge_unexplained(queries, view, view_points_in_camera, options);
  const FrustumLimits volume = view_volume(view.frame.camera, options);
  std::vector<Evidence> evidence(previous_in_camera.size(), Evidence::kPresent);
  for (std::size_t i = 0; i < unexplained.size(); ++i)
    evidence[unexplained[i]] = volume.contains(queries[i]) ? judged[i] : Evidence::kUnobserved;
  return evidence;
}

/// Of the novel points, those whose place an earlier view saw empty (see detect_changes()).
std::vector<int> keep_seen_through(const std::vector<int>& novel, const Points& view_points_in_camera,
                                   const PreparedView& view, std::span<const PreparedView* const> earlier_views,
                                   const DetectChangesOptions& options) {
  std::vector<std::uint8_t> is_new(view_points_in_camera.size());
  std::vector<int> open = novel;  // not yet seen through
  for (const PreparedView* earlier : earlier_views) {
    const RgbdFrame& frame = earlier->frame;
    const Points queries = transform_points(frame.world_from_camera.inverse() * view.frame.world_from_camera,
                                            select_points(view_points_in_camera, open));
    const std::vector<Evidence> evidence =
        classify_against_depth(queries, frame.camera, frame.depth_m, depth_options(options));
    const FrustumLimits volume = view_volume(frame.camera, options);
    std::vector<int> still_open;
    for (std::size_t i = 0; i < open.size(); ++i) {
      const bool seen_through = evidence[i] == Evidence::kSeenThrough && volume.contains(queries[i]);
      if (seen_through)
        is_new[open[i]] = 1;
      else
        still_open.push_back(open[i]);
    }
    open = std::move(still_open);
  }
  std::vector<int> kept;
  std::copy_if(novel.begin(), novel.end(), std::back_inserter(kept), [&](int i) { return is_new[i] != 0; });
  return kept;
}

double share(std::size_t part, std::size_t rest) {
  return part == 0 ? 0.0 : static_cast<double>(part) / static_cast<double>(part + rest);
}

PointCloud cloud_of_pixels(const std::vector<int>& indices, const ViewPoints& points, const PreparedView& view) {
  const Rigid3f world_from_camera(view.frame.world_from_camera);
  PointCloud cloud_in_world;
  for (const int i : indices) {
    cloud_in_world.points.push_back(world_from_camera * points.in_camera[i]);
    cloud_in_world.colors.push_back(view.frame.color[points.pixels[i]]);
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

void DetectChangesOptions::check() const {
  check_positive("DetectChangesOptions.tolerance_m", tolerance_m);
  check_in_range("DetectChangesOptions.tolerance_sigmas", tolerance_sigmas, 0, 10);
  check_positive("DetectChangesOptions.voxel_m", voxel_m);
  check_in_range("DetectChangesOptions.bin_size_rad", bin_size_rad, 0.001, std::numbers::pi / 2);
  check_not_negative("DetectChangesOptions.occlusion_margin_m", occlusion_margin_m);
  check_not_negative("DetectChangesOptions.occlusion_sigmas", occlusion_sigmas);
  check_in_range("DetectChangesOptions.window_radius_px", window_radius_px, 0, 100);
  check_not_negative("DetectChangesOptions.min_depth_m", min_depth_m);
  require(std::isfinite(max_depth_m) && max_depth_m > min_depth_m,
          "DetectChangesOptions.max_depth_m (must be finite and > min_depth_m)");
  check_in_range("DetectChangesOptions.frustum_margin_rad", frustum_margin_rad, 0, std::numbers::pi / 2);
  check_in_range("DetectChangesOptions.max_changed_share", max_changed_share, 0, 1);
  check_positive("DetectChangesOptions.num_threads", num_threads);
}

ChangeResult detect_changes(const PointCloud& previous_in_world, const PreparedView& view,
                            const DetectChangesOptions& options, std::span<const PreparedView* const> earlier_views) {
  options.check();
  check_views(view, earlier_views);
  if (!options.novel_needs_free_space) earlier_views = {};
  ChangeResult result;
  result.novel_mask = Image<std::uint8_t>(view.cloud.width(), view.cloud.height());
  if (previous_in_world.empty()) return result;

  // All in the camera frame: moving Psi there is cheaper than moving the view's points to the world.
  const bool thin = is_thin(previous_in_world, options.voxel_m);
  const PointCloud thinned = thin ? PointCloud{} : voxel_downsample(previous_in_world, options.voxel_m);
  const PointCloud& psi_in_world = thin ? previous_in_world : thinned;
  const Rigid3 camera_from_world = view.frame.world_from_camera.inverse();
  const Points psi_in_camera = transform_points(camera_from_world, psi_in_world.points);
  const ViewPoints points = collect_points(view.cloud);

  const std::vector<Evidence> evidence = judge_previous(psi_in_camera, view, points.in_camera, options);
  std::vector<int> removed;
  for (std::size_t i = 0; i < evidence.size(); ++i) {
    ++result.evidence_count[static_cast<std::size_t>(evidence[i])];
    if (evidence[i] == Evidence::kSeenThrough) removed.push_back(static_cast<int>(i));
  }
  result.changed_share = share(removed.size(), result.evidence_count[static_cast<std::size_t>(Evidence::kPresent)]);

  const ProximityGrid dense_psi(thin ? psi_in_camera : transform_points(camera_from_world, previous_in_world.points),
                                options.tolerance_m);
  std::vector<int> novel = find_unexplained(points.in_camera, dense_psi, view.frame.camera.fx, options);
  const std::size_t num_explained = points.in_camera.size() - novel.size();
  if (!earlier_views.empty()) novel = keep_seen_through(novel, points.in_camera, view, earlier_views, options);
  result.novel_share = share(novel.size(), num_explained);

  // Without earlier views a large share of N may only mean that the camera looks at something else.
  result.pose_suspect = result.changed_share > options.max_changed_share ||
                        (!earlier_views.empty() && result.novel_share > options.max_changed_share);
  if (result.pose_suspect) return result;
  result.removed_in_world = select(psi_in_world, removed);
  result.novel_in_world = voxel_downsample(cloud_of_pixels(novel, points, view), options.voxel_m);
  for (const int i : novel) result.novel_mask[points.pixels[i]] = 1;
  return result;
}

}  // namespace resight
