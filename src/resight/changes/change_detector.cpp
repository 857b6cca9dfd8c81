// SPDX-License-Identifier: Apache-2.0
#include "resight/changes/change_detector.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "resight/core/check.hpp"

namespace resight {
namespace {

constexpr double kMinDepth_m = 0.05;
constexpr double kDiscRadius_voxels = 0.6;  // Discs of neighbouring voxels overlap a little.

double share(std::size_t part, std::size_t rest) {
  return part == 0 ? 0.0 : static_cast<double>(part) / static_cast<double>(part + rest);
}

std::size_t num_present(const std::array<int, 4>& evidence_count) {
  return static_cast<std::size_t>(evidence_count[static_cast<std::size_t>(Evidence::kPresent)]);
}

/// Surface of these pixels, with colours.
PointCloud cloud_of_pixels(const std::vector<int>& pixels, const PreparedView& view) {
  const Rigid3f world_from_camera(view.frame.world_from_camera);
  PointCloud cloud_in_world;
  for (const int i : pixels) {
    cloud_in_world.points.push_back(world_from_camera * view.cloud.point(static_cast<std::size_t>(i)));
    cloud_in_world.colors.push_back(view.frame.color[static_cast<std::size_t>(i)]);
  }
  return cloud_in_world;
}

/// Sets the pixels whose centre is in the disc, and the one that holds its centre.
void draw_disc(const Camera& camera, const Eigen::Vector2d& center_px, double radius_px, Image<std::uint8_t>& mask) {
  const auto first = [](double from) { return static_cast<int>(std::ceil(std::max(from, 0.0))); };
  const auto last = [](double to, int size) { return static_cast<int>(std::floor(std::min(to, size - 1.0))); };
  for (int v = first(center_px.y() - radius_px); v <= last(center_px.y() + radius_px, mask.height()); ++v)
    for (int u = first(center_px.x() - radius_px); u <= last(center_px.x() + radius_px, mask.width()); ++u)
      if ((Eigen::Vector2d(u, v) - center_px).norm() <= radius_px) mask(u, v) = 1;
  if (const auto pixel = camera.pixel_at(center_px)) mask(pixel->u, pixel->v) = 1;
}

/// Pixels of the view at which the surface is that these points, one per voxel, were sampled from.
Image<std::uint8_t> mask_of_points(const PointCloud& cloud_in_world, const PreparedView& view, double voxel_m) {
  const Camera& camera = view.frame.camera;
  Image<std::uint8_t> mask(view.cloud.width(), view.cloud.height());
  const Rigid3 camera_from_world = view.frame.world_from_camera.inverse();
  for (const Eigen::Vector3f& p_in_world : cloud_in_world.points) {
    const Eigen::Vector3d p = camera_from_world * p_in_world.cast<double>().eval();
    if (p.z() > kMinDepth_m)
      draw_disc(camera, camera.project(p), kDiscRadius_voxels * voxel_m * camera.fx / p.z(), mask);
  }
  return mask;
}

/// The clouds and the mask that both tests report.
ChangeResult make_result(const PreparedView& view, const std::vector<int>& novel, PointCloud removed_in_world,
                         const DetectChangesOptions& options) {
  ChangeResult result;
  result.novel_in_world = voxel_downsample(cloud_of_pixels(novel, view), options.voxel_m);
  result.novel_mask = Image<std::uint8_t>(view.cloud.width(), view.cloud.height());
  for (const int i : novel) result.novel_mask[static_cast<std::size_t>(i)] = 1;
  result.removed_in_world = std::move(removed_in_world);
  return result;
}

ChangeResult no_changes(const PreparedView& view) {
  ChangeResult result;
  result.novel_mask = result.removed_mask = Image<std::uint8_t>(view.cloud.width(), view.cloud.height());
  return result;
}

ChangeResult detect_by_points(const PointCloud& previous_in_world, const PreparedView& view,
                              const DetectChangesOptions& options, std::span<const PreparedView* const> earlier_views,
                              double previous_voxel_m) {
  const auto& test = std::get<PointTestOptions>(options.test);
  const bool is_sparse = previous_voxel_m == options.voxel_m || is_downsampled(previous_in_world, options.voxel_m);
  const PointCloud downsampled = is_sparse ? PointCloud{} : voxel_downsample(previous_in_world, options.voxel_m);
  const PointCloud& psi_in_world = is_sparse ? previous_in_world : downsampled;
  const PointChanges changes =
      find_point_changes({previous_in_world, psi_in_world}, view, earlier_views, test, options.num_threads);
  ChangeResult result = make_result(view, changes.novel, select(psi_in_world, changes.removed), options);
  result.removed_mask = mask_of_points(result.removed_in_world, view, options.voxel_m);
  result.evidence_count = changes.evidence_count;
  result.changed_share = share(changes.removed.size(), num_present(changes.evidence_count));
  result.novel_share = share(changes.novel.size(), changes.num_explained);
  // Without earlier views a large share of N may only mean that the camera looks at something else.
  result.pose_suspect =
      result.changed_share > options.max_changed_share ||
      (test.novel_needs_free_space && !earlier_views.empty() && result.novel_share > options.max_changed_share);
  return result;
}

ChangeResult detect_by_depth(const PreparedView& view, const DetectChangesOptions& options,
                             std::span<const PreparedView* const> earlier_views) {
  DepthChanges changes =
      find_depth_changes(view, earlier_views, std::get<DepthTestOptions>(options.test), options.num_threads);
  PointCloud gone_in_world;
  for (std::size_t e = 0; e < earlier_views.size(); ++e) {
    const PointCloud gone = cloud_of_pixels(changes.gone_pixels[e], *earlier_views[e]);
    if (!gone.empty()) gone_in_world.append(gone);
  }
  const std::size_t num_gone = gone_in_world.size();
  std::vector<int> novel;
  for (std::size_t i = 0; i < changes.novel.size(); ++i)
    if (changes.novel[i] != 0) novel.push_back(static_cast<int>(i));
  ChangeResult result = make_result(view, novel, voxel_downsample(gone_in_world, options.voxel_m), options);
  result.removed_mask = std::move(changes.removed);
  result.evidence_count = changes.evidence_count;
  result.changed_share = share(num_gone, num_present(changes.evidence_count));
  result.novel_share = share(novel.size(), changes.num_explained);
  result.pose_suspect = std::max(result.changed_share, result.novel_share) > options.max_changed_share;
  return result;
}

void check_views(const PreparedView& view, std::span<const PreparedView* const> earlier_views) {
  const auto is_consistent = [](const PreparedView& v) {
    const Camera& camera = v.frame.camera;
    const auto has_size = [&](const auto& image) {
      return image.width() == camera.width && image.height() == camera.height;
    };
    return camera.is_valid() && has_size(v.frame.depth_m) && has_size(v.frame.color) && has_size(v.cloud.z);
  };
  require(is_consistent(view), "detect_changes: the images of the view do not have the size of its camera");
  for (const PreparedView* earlier : earlier_views)
    require(earlier != nullptr && is_consistent(*earlier),
            "detect_changes: an earlier view is null, or its images do not have the size of its camera");
}

}  // namespace

ChangeResult detect_changes(const PointCloud& previous_in_world, const PreparedView& view,
                            const DetectChangesOptions& options, std::span<const PreparedView* const> earlier_views,
                            double previous_voxel_m) {
  options.check();
  check_views(view, earlier_views);
  if (previous_in_world.empty()) return no_changes(view);
  ChangeResult result = std::holds_alternative<DepthTestOptions>(options.test)
                            ? detect_by_depth(view, options, earlier_views)
                            : detect_by_points(previous_in_world, view, options, earlier_views, previous_voxel_m);
  if (!result.pose_suspect) return result;
  ChangeResult suspect = no_changes(view);
  suspect.evidence_count = result.evidence_count;
  suspect.changed_share = result.changed_share;
  suspect.novel_share = result.novel_share;
  suspect.pose_suspect = true;
  return suspect;
}

}  // namespace resight
