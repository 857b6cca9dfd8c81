// SPDX-License-Identifier: Apache-2.0
#include "resight/changes/change_regions.hpp"

#include <algorithm>
#include <functional>
#include <iterator>
#include <span>
#include <utility>

#include "resight/core/disjoint_sets.hpp"
#include "resight/geometry/kd_tree.hpp"
#include "resight/sensor/noise_model.hpp"
#include "resight/sensor/pixel_components.hpp"

namespace resight {
namespace {

// Points of one surface are up to 1.7 voxels apart (the diagonal); noise and grazing angles leave further gaps.
constexpr double kMaxGap_voxels = 4;
// A region beside one of ten times as many points in the image is a fragment at a depth edge, and belongs to it.
constexpr std::size_t kMinTimesLarger = 10;
constexpr int kFragmentGap_px = 2;

// The largest distance of connected points at a depth: there, pixels lie apart, and noise and the steps of disparity
// pull the surface apart along the ray.
double max_gap_m(const Camera& camera, double z_m, double voxel_m) {
  constexpr double kNoiseSigmas = 3;
  const double pixels_m = 2 * z_m / camera.fx;
  return std::max({kMaxGap_voxels * voxel_m, pixels_m, kNoiseSigmas * axial_noise_m(camera.noise, z_m)});
}

// Indices of the points of each region, ascending; largest region first.
std::vector<std::vector<int>> connect_points(std::span<const Eigen::Vector3f> points_in_world, const RgbdFrame& frame,
                                             double voxel_m) {
  const KdTree tree(points_in_world);
  const Rigid3f camera_from_world(frame.world_from_camera.inverse());
  DisjointSets connected(points_in_world.size());
  std::vector<PointNeighbor> neighbors;
  for (std::size_t i = 0; i < points_in_world.size(); ++i) {
    const double z_m = std::max((camera_from_world * points_in_world[i]).z(), 0.0F);
    tree.within(points_in_world[i], max_gap_m(frame.camera, z_m, voxel_m), neighbors);
    for (const PointNeighbor& neighbor : neighbors) connected.join(static_cast<int>(i), neighbor.index);
  }
  std::vector<std::vector<int>> regions(points_in_world.size());
  for (std::size_t i = 0; i < points_in_world.size(); ++i)
    regions[static_cast<std::size_t>(connected.root(static_cast<int>(i)))].push_back(static_cast<int>(i));
  std::erase_if(regions, [](const std::vector<int>& region) { return region.empty(); });
  std::ranges::stable_sort(regions, [](const auto& a, const auto& b) { return a.size() > b.size(); });
  return regions;
}

// Gives each pixel of the mask to the region whose projection is nearest.
void assign_pixels(const RgbdFrame& frame, const Image<std::uint8_t>& mask, std::span<ChangeRegion> regions) {
  const Rigid3 camera_from_world = frame.world_from_camera.inverse();
  std::vector<Eigen::Vector3f> projected_px;  // z = 0.
  std::vector<std::size_t> region_of;
  for (std::size_t r = 0; r < regions.size(); ++r) {
    for (const Eigen::Vector3f& p_in_world : regions[r].surface_in_world.points) {
      const Eigen::Vector3d p_in_camera = camera_from_world * p_in_world.cast<double>().eval();
      if (!(p_in_camera.z() > 0)) continue;
      const Eigen::Vector2d px = frame.camera.project(p_in_camera);
      projected_px.emplace_back(static_cast<float>(px.x()), static_cast<float>(px.y()), 0.0F);
      region_of.push_back(r);
    }
  }
  const KdTree tree(projected_px);
  for (int v = 0; v < mask.height(); ++v) {
    for (int u = 0; u < mask.width(); ++u) {
      if (mask(u, v) == 0) continue;
      const int nearest = tree.nearest({static_cast<float>(u), static_cast<float>(v), 0.0F}).index;
      if (nearest >= 0)
        regions[region_of[static_cast<std::size_t>(nearest)]].pixels.push_back(static_cast<int>(mask.index(u, v)));
    }
  }
}

// Joins each fragment with the largest region of its connected pixels. Regions are in descending order of size.
std::vector<ChangeRegion> join_fragments(std::vector<ChangeRegion> regions, const Image<std::uint8_t>& mask) {
  constexpr int kNone = -1;
  Image<int> component_of(mask.width(), mask.height());
  std::vector<int> largest_of;  // Number in `joined`, by component.
  for (const std::vector<int>& pixels : find_pixel_components(mask, kFragmentGap_px)) {
    for (const int i : pixels) component_of[static_cast<std::size_t>(i)] = static_cast<int>(largest_of.size());
    largest_of.push_back(kNone);
  }
  const auto largest_at = [&](int pixel) -> int& {
    return largest_of[static_cast<std::size_t>(component_of[static_cast<std::size_t>(pixel)])];
  };
  std::vector<ChangeRegion> joined;
  for (ChangeRegion& region : regions) {
    const int larger = region.pixels.empty() ? kNone : largest_at(region.pixels.front());
    const std::size_t size = region.surface_in_world.size();
    if (larger != kNone && kMinTimesLarger * size < joined[static_cast<std::size_t>(larger)].surface_in_world.size()) {
      ChangeRegion& home = joined[static_cast<std::size_t>(larger)];
      home.surface_in_world.append(region.surface_in_world);
      home.pixels.insert(home.pixels.end(), region.pixels.begin(), region.pixels.end());
      continue;
    }
    for (const int pixel : region.pixels)
      if (largest_at(pixel) == kNone) largest_at(pixel) = static_cast<int>(joined.size());
    joined.push_back(std::move(region));
  }
  return joined;
}

std::vector<ChangeRegion> find_regions(const RgbdFrame& frame, const PointCloud& changed_in_world,
                                       const Image<std::uint8_t>& mask, RegionKind kind, double voxel_m) {
  std::vector<ChangeRegion> regions;
  for (const std::vector<int>& indices : connect_points(changed_in_world.points, frame, voxel_m))
    regions.push_back({kind, select(changed_in_world, indices), {}, {}});
  assign_pixels(frame, mask, regions);
  regions = join_fragments(std::move(regions), mask);
  for (ChangeRegion& region : regions) {
    std::ranges::sort(region.pixels);
    region.box = fit_box(region.surface_in_world);
  }
  std::ranges::stable_sort(regions, std::greater{}, [](const ChangeRegion& r) { return r.surface_in_world.size(); });
  return regions;
}

}  // namespace

const char* to_string(RegionKind kind) { return kind == RegionKind::kNovel ? "novel" : "removed"; }

std::vector<ChangeRegion> find_change_regions(const RgbdFrame& frame, const ChangeResult& changes, double voxel_m) {
  std::vector<ChangeRegion> regions =
      find_regions(frame, changes.novel_in_world, changes.novel_mask, RegionKind::kNovel, voxel_m);
  std::vector<ChangeRegion> removed =
      find_regions(frame, changes.removed_in_world, changes.removed_mask, RegionKind::kRemoved, voxel_m);
  std::ranges::move(removed, std::back_inserter(regions));
  return regions;
}

}  // namespace resight
