// SPDX-License-Identifier: Apache-2.0
#include "resight/modelling/build_model.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "resight/core/check.hpp"
#include "resight/core/parallel.hpp"
#include "resight/core/statistics.hpp"
#include "resight/geometry/kd_tree.hpp"
#include "resight/geometry/mesh_sampling.hpp"
#include "resight/sensor/crop_view.hpp"

namespace resight {
namespace {

constexpr double kThin_m = 0.005;
// Samples of the mesh per point of the cloud.
constexpr double kSamplesPerPoint = 4;
constexpr int kTrainingMargin_px = 10;

double degrees(double rad) { return rad * 180 / std::numbers::pi; }

PointCloud make_cloud(const TriangleMesh& mesh, double spacing_m) {
  return voxel_downsample(sample_surface(mesh, kSamplesPerPoint / (spacing_m * spacing_m)), spacing_m);
}

// Share of points with an oppositely oriented point less than kThin_m behind them.
double measure_thin_share(const PointCloud& cloud) {
  if (cloud.empty()) return 0;
  const KdTree tree(cloud.points);
  std::vector<PointNeighbor> neighbors;
  std::size_t thin = 0;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    tree.within(cloud.points[i], kThin_m, neighbors);
    thin += std::ranges::any_of(neighbors, [&](const PointNeighbor& n) {
      return cloud.normals[n.index].dot(cloud.normals[i]) < -0.7F &&
             (cloud.points[n.index] - cloud.points[i]).dot(cloud.normals[i]) < 0;
    });
  }
  return static_cast<double>(thin) / static_cast<double>(cloud.size());
}

struct PixelCount {
  std::size_t inside = 0;
  std::size_t without_depth = 0;
};

// Pixels between the first and the last object pixel of a row count as inside if they are object or have no depth.
PixelCount count_returns(const TrainingView& view) {
  PixelCount count;
  for (int v = 0; v < view.mask.height(); ++v) {
    const auto row = view.mask.row(v);
    const auto is_set = [](std::uint8_t m) { return m != 0; };
    const auto first = std::ranges::find_if(row, is_set) - row.begin();
    const auto last =
        row.size() - static_cast<std::size_t>(std::find_if(row.rbegin(), row.rend(), is_set) - row.rbegin());
    for (auto u = static_cast<std::size_t>(first); u < last; ++u) {
      const bool has_depth = !std::isnan(view.frame.depth_m(static_cast<int>(u), v));
      count.inside += row[u] != 0 || !has_depth;
      count.without_depth += !has_depth;
    }
  }
  return count;
}

double measure_no_return_share(std::span<const TrainingView> views) {
  PixelCount sum;
  for (const TrainingView& view : views) {
    const PixelCount count = count_returns(view);
    sum.inside += count.inside;
    sum.without_depth += count.without_depth;
  }
  return sum.inside == 0 ? 0 : static_cast<double>(sum.without_depth) / static_cast<double>(sum.inside);
}

double count_keypoints(std::span<const TrainingView> views, std::span<const int> key_views,
                       const BuildModelOptions& options) {
  if (key_views.empty()) return 0;
  std::vector<double> counts(key_views.size());
  parallel_for(key_views.size(), options.num_threads, [&](std::size_t k) {
    TrainingView part = crop_to_object(views[key_views[k]], kTrainingMargin_px);
    if (part.mask.empty()) return;
    counts[k] = static_cast<double>(extract_sift(prepare_view(std::move(part.frame)), options.sift, &part.mask).size());
  });
  return upper_median(std::move(counts));
}

std::string describe_symmetries(const ObjectSymmetries& symmetries) {
  if (symmetries.none()) return "none found";
  return fmt::format("{} axes of revolution, {} discrete symmetries", symmetries.continuous.size(),
                     symmetries.discrete.size());
}

std::vector<std::string> find_troubles(const ModelReport& r, const BuildModelOptions& o) {
  std::vector<std::string> troubles;
  if (r.keypoints_per_view < o.min_keypoints)
    troubles.push_back(fmt::format("few features: {:.0f} keypoints per view; it can only be recognised by its shape",
                                   r.keypoints_per_view));
  if (r.no_return_share > o.max_no_return)
    troubles.push_back(
        fmt::format("shiny, dark or transparent: {:.0f} % of its pixels have no depth", 100 * r.no_return_share));
  if (r.thin_share > o.max_thin_share)
    troubles.push_back(
        fmt::format("thin: {:.0f} % of its surface is less than {:.0f} mm thick", 100 * r.thin_share, 1000 * kThin_m));
  if (r.holes.open_share > o.max_open_share)
    troubles.push_back(fmt::format("holes: {:.0f} % of its surface was not observed; record it from another side too",
                                   100 * r.holes.open_share));
  if (r.coverage.share < o.min_coverage)
    troubles.push_back(fmt::format(
        "observed from {:.0f} % of all directions; the largest gap is {:.0f} deg wide around ({:.1f}, {:.1f}, {:.1f})",
        100 * r.coverage.share, degrees(2 * r.coverage.largest_gap_rad), r.coverage.largest_gap.x(),
        r.coverage.largest_gap.y(), r.coverage.largest_gap.z()));
  if (!r.symmetries.none()) troubles.push_back("symmetric: its pose is determined only up to its symmetries");
  return troubles;
}

Eigen::Vector3d measure_extent(const TriangleMesh& mesh) {
  Eigen::Vector3f low = mesh.vertices.front();
  Eigen::Vector3f high = low;
  for (const Eigen::Vector3f& p : mesh.vertices) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  return (high - low).cast<double>();
}

}  // namespace

void BuildModelOptions::check() const {
  fuse.check();
  check_in_range("BuildModelOptions.key_view_angle_rad", key_view_angle_rad, 0, std::numbers::pi);
  check_in_range("BuildModelOptions.cloud_spacing_m", cloud_spacing_m, 0.0005, 0.05);
  sift.check();
  symmetry.check();
  check_not_negative("BuildModelOptions.min_keypoints", min_keypoints);
  check_in_range("BuildModelOptions.max_no_return", max_no_return, 0, 1);
  check_in_range("BuildModelOptions.max_thin_share", max_thin_share, 0, 1);
  check_in_range("BuildModelOptions.max_open_share", max_open_share, 0, 1);
  check_in_range("BuildModelOptions.min_coverage", min_coverage, 0, 1);
  check_in_range("BuildModelOptions.num_threads", num_threads, 1, 4096);
}

Result<ObjectModelBuild> build_model(std::span<const TrainingView> views, const BuildModelOptions& options) {
  options.check();
  ObjectModelBuild build;
  FuseViewsOptions fuse = options.fuse;
  fuse.num_threads = options.num_threads;
  build.mesh = fuse_views(views, fuse);
  if (build.mesh.empty()) return Error{fmt::format("the {} views show no surface of the object", views.size())};
  build.cloud = make_cloud(build.mesh, options.cloud_spacing_m);
  std::vector<Rigid3> poses;
  for (const TrainingView& view : views) poses.push_back(view.frame.world_from_camera);
  const Eigen::Vector3d center = centroid(build.cloud.points).cast<double>();
  build.key_views = choose_key_views(poses, center, options.key_view_angle_rad);

  ModelReport& report = build.report;
  report.num_views = static_cast<int>(views.size());
  report.num_key_views = static_cast<int>(build.key_views.size());
  std::vector<Rigid3> key_poses;
  for (const int i : build.key_views) key_poses.push_back(poses[i]);
  report.coverage = measure_coverage(key_poses, center);
  report.holes = measure_holes(build.mesh);
  report.extent_m = measure_extent(build.mesh);
  report.diameter_m = static_cast<double>(diameter(build.cloud.points));
  report.keypoints_per_view = count_keypoints(views, build.key_views, options);
  report.no_return_share = measure_no_return_share(views);
  report.thin_share = measure_thin_share(build.cloud);
  SymmetryOptions symmetry = options.symmetry;
  symmetry.num_threads = options.num_threads;
  report.symmetries = find_symmetries(build.cloud, symmetry);
  report.troubles = find_troubles(report, options);
  return build;
}

std::string format_report(const ModelReport& r) {
  std::string text = fmt::format(
      "views         {} ({} used for training)\nsize          {:.0f} x {:.0f} x {:.0f} mm, diameter {:.0f} mm\n"
      "coverage      {:.0f} % of all directions ({:.0f} % from above, {:.0f} % from below), largest gap {:.0f} deg\n"
      "holes         {} (open: {:.1f} % of the surface, {:.0f} mm of open edges)\nkeypoints     {:.0f} per view\n"
      "no return     {:.1f} % of its pixels\nsymmetries    {}\n",
      r.num_views, r.num_key_views, 1000 * r.extent_m.x(), 1000 * r.extent_m.y(), 1000 * r.extent_m.z(),
      1000 * r.diameter_m, 100 * r.coverage.share, 100 * r.coverage.share_above, 100 * r.coverage.share_below,
      degrees(2 * r.coverage.largest_gap_rad), r.holes.count, 100 * r.holes.open_share,
      1000 * r.holes.boundary_length_m, r.keypoints_per_view, 100 * r.no_return_share,
      describe_symmetries(r.symmetries));
  if (!std::isnan(r.closure_error_m)) text += fmt::format("closure error {:.1f} mm\n", 1000 * r.closure_error_m);
  for (const std::string& trouble : r.troubles) text += "warning       " + trouble + "\n";
  return text;
}

}  // namespace resight
