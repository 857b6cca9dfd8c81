// SPDX-License-Identifier: Apache-2.0
#include "resight/changes/change_regions.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <span>
#include <utility>

#include "resight/geometry/kd_tree.hpp"
#include "resight/sensor/pixel_components.hpp"

namespace resight {
namespace {

// Points of one surface are up to 1.7 voxels apart (the diagonal); noise and grazing angles leave further gaps.
constexpr double kMaxGap_voxels = 4;
// Smaller pieces beside a larger one in the image are flakes at a depth edge, and belong to it.
constexpr std::size_t kFewPoints = 10;
constexpr int kFlakeGap_px = 2;

// Indices of the points of each region, ascending.
std::vector<std::vector<int>> connect_points(std::span<const Eigen::Vector3f> points, double max_gap_m) {
  const KdTree tree(points);
  std::vector<std::vector<int>> regions;
  std::vector<std::uint8_t> reached(points.size());
  std::vector<PointNeighbor> neighbors;
  for (std::size_t start = 0; start < points.size(); ++start) {
    if (reached[start] != 0) continue;
    reached[start] = 1;
    std::vector<int> region{static_cast<int>(start)};
    for (std::size_t next = 0; next < region.size(); ++next) {
      tree.within(points[static_cast<std::size_t>(region[next])], max_gap_m, neighbors);
      for (const PointNeighbor& neighbor : neighbors)
        if (std::exchange(reached[static_cast<std::size_t>(neighbor.index)], std::uint8_t{1}) == 0)
          region.push_back(neighbor.index);
    }
    std::ranges::sort(region);
    regions.push_back(std::move(region));
  }
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

// Joins pieces of few points with the largest region of their connected pixels.
void join_flakes(const Image<std::uint8_t>& mask, std::size_t first, std::vector<ChangeRegion>& regions) {
  Image<int> component(mask.width(), mask.height(), -1);
  std::vector<std::size_t> largest;  // Region of each component. Regions are in descending order of size.
  for (const std::vector<int>& pixels : find_pixel_components(mask, kFlakeGap_px)) {
    for (const int i : pixels) component[static_cast<std::size_t>(i)] = static_cast<int>(largest.size());
    largest.push_back(regions.size());
  }
  std::vector<ChangeRegion> kept;
  for (std::size_t r = first; r < regions.size(); ++r) {
    ChangeRegion& region = regions[r];
    for (const int i : region.pixels) {
      std::size_t& of_component = largest[static_cast<std::size_t>(component[static_cast<std::size_t>(i)])];
      of_component = std::min(of_component, first + kept.size());
    }
    const bool is_flake = region.surface_in_world.size() < kFewPoints && !region.pixels.empty();
    const std::size_t home =
        is_flake ? largest[static_cast<std::size_t>(component[static_cast<std::size_t>(region.pixels.front())])]
                 : first + kept.size();
    if (home == first + kept.size()) {
      kept.push_back(std::move(region));
      continue;
    }
    ChangeRegion& larger = kept[home - first];
    larger.surface_in_world.append(region.surface_in_world);
    larger.pixels.insert(larger.pixels.end(), region.pixels.begin(), region.pixels.end());
  }
  regions.resize(first);
  for (ChangeRegion& region : kept) {
    std::ranges::sort(region.pixels);
    regions.push_back(std::move(region));
  }
}

void add_regions(const RgbdFrame& frame, const PointCloud& changed_in_world, const Image<std::uint8_t>& mask,
                 RegionKind kind, double max_gap_m, std::vector<ChangeRegion>& regions) {
  const std::size_t first = regions.size();
  for (const std::vector<int>& indices : connect_points(changed_in_world.points, max_gap_m)) {
    regions.push_back({kind, select(changed_in_world, indices), {}, {}});
  }
  assign_pixels(frame, mask, std::span(regions).subspan(first));
  join_flakes(mask, first, regions);
  for (ChangeRegion& region : std::span(regions).subspan(first)) region.box = fit_box(region.surface_in_world);
}

}  // namespace

const char* to_string(RegionKind kind) { return kind == RegionKind::kNovel ? "novel" : "removed"; }

OrientedBox fit_box(const PointCloud& cloud_in_world) {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3f& p : cloud_in_world.points) mean += p.cast<double>();
  mean /= static_cast<double>(cloud_in_world.size());
  Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
  for (const Eigen::Vector3f& p : cloud_in_world.points) {
    const Eigen::Vector3d d = p.cast<double>() - mean;
    scatter += d * d.transpose();
  }
  const Eigen::Matrix3d axes = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(scatter).eigenvectors();
  Eigen::Vector3d low = Eigen::Vector3d::Zero();
  Eigen::Vector3d high = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3f& p : cloud_in_world.points) {
    const Eigen::Vector3d along = axes.transpose() * (p.cast<double>() - mean);
    low = low.cwiseMin(along);
    high = high.cwiseMax(along);
  }
  // Sides from the longest to the shortest; a third axis that makes the frame right-handed.
  std::array<int, 3> order{0, 1, 2};
  const Eigen::Vector3d size_m = high - low;
  std::ranges::stable_sort(order, [&](int a, int b) { return size_m[a] > size_m[b]; });
  OrientedBox box;
  for (int i = 0; i < 3; ++i) box.size_m[i] = size_m[order[static_cast<std::size_t>(i)]];
  box.world_from_box.translation = mean + axes * (low + high) / 2;
  box.world_from_box.rotation << axes.col(order[0]), axes.col(order[1]), axes.col(order[0]).cross(axes.col(order[1]));
  return box;
}

std::vector<ChangeRegion> find_change_regions(const RgbdFrame& frame, const ChangeResult& changes, double voxel_m) {
  const double max_gap_m = kMaxGap_voxels * voxel_m;
  std::vector<ChangeRegion> regions;
  add_regions(frame, changes.novel_in_world, changes.novel_mask, RegionKind::kNovel, max_gap_m, regions);
  add_regions(frame, changes.removed_in_world, changes.removed_mask, RegionKind::kRemoved, max_gap_m, regions);
  return regions;
}

}  // namespace resight
