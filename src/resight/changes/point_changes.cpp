// SPDX-License-Identifier: Apache-2.0
#include "resight/changes/point_changes.hpp"

#include <algorithm>
#include <cmath>

#include "resight/changes/spherical_occlusion.hpp"
#include "resight/changes/view_difference.hpp"
#include "resight/core/parallel.hpp"
#include "resight/evidence/surface_evidence.hpp"
#include "resight/geometry/spherical_bins.hpp"
#include "resight/geometry/view_frustum.hpp"

namespace resight {
namespace {

using Points = std::vector<Eigen::Vector3f>;
constexpr std::size_t kPointsPerTransform = 4096;

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
  parallel_for_blocks(points_in_b.size(), kPointsPerTransform, num_threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) points_in_a[i] = motion * points_in_b[i];
  });
  return points_in_a;
}

/// Compares points with views by the paper's rules.
class PointTest {
 public:
  PointTest(const PointTestOptions& options, int num_threads) : options_(options), num_threads_(num_threads) {}

  /// Alg. 1, lines 1 to 3, for every point of Psi. `explained_pixels`: see find_explained_points().
  [[nodiscard]] std::vector<Evidence> classify_previous(const Points& psi_in_camera, const PreparedView& view,
                                                        Image<std::uint8_t>* explained_pixels) const;
  /// Pixels of the view without a point of Psi.
  [[nodiscard]] std::vector<int> find_unexplained(const Points& psi_in_camera, const PreparedView& view,
                                                  const Image<std::uint8_t>& explained_pixels) const {
    return find_unexplained_pixels(psi_in_camera, view.cloud, view.frame.camera, options_.tolerance_m, num_threads_,
                                   explained_pixels);
  }
  /// Of these pixels of the view, those whose place an earlier view saw empty.
  [[nodiscard]] std::vector<int> keep_seen_through(std::vector<int> pixels, const PreparedView& view,
                                                   std::span<const PreparedView* const> earlier_views) const;

 private:
  [[nodiscard]] FrustumLimits view_volume(const Camera& camera) const {
    return ViewFrustum{camera, options_.min_depth_m, options_.max_depth_m, options_.frustum_margin_rad}.limits();
  }
  [[nodiscard]] std::vector<Evidence> classify_unexplained(const Points& in_camera, const PreparedView& view,
                                                           const OrganizedCloud& measured) const;
  [[nodiscard]] std::vector<std::uint8_t> find_seen_through(const std::vector<int>& pixels, const PreparedView& view,
                                                            const PreparedView& earlier) const;

  const PointTestOptions& options_;
  int num_threads_;
};

/// What the view says about points of the past that nothing of it explains.
std::vector<Evidence> PointTest::classify_unexplained(const Points& in_camera, const PreparedView& view,
                                                      const OrganizedCloud& measured) const {
  const DepthImage image{view.frame.camera, view.frame.depth_m};
  std::vector<Evidence> evidence =
      classify_occlusion(in_camera, collect_points(measured), SphericalBins(options_.bin_size_rad),
                         options_.occlusion_margin_m, num_threads_);
  if (!options_.require_return) return evidence;
  for (std::size_t i = 0; i < evidence.size(); ++i) {
    if (evidence[i] == Evidence::kSeenThrough &&
        std::isnan(nearest_depth(in_camera[i], image, options_.window_radius_px)))
      evidence[i] = Evidence::kUnobserved;
  }
  return evidence;
}

std::vector<Evidence> PointTest::classify_previous(const Points& psi_in_camera, const PreparedView& view,
                                                   Image<std::uint8_t>* explained_pixels) const {
  const Camera& camera = view.frame.camera;
  // The cloud of the view ends at prepare.max_depth_m; what lies beyond explains and hides points, too.
  const OrganizedCloud measured = back_project(camera, view.frame.depth_m);
  const std::vector<std::uint8_t> explained =
      find_explained_points(psi_in_camera, measured, camera, options_.tolerance_m, num_threads_, explained_pixels);
  const FrustumLimits volume = view_volume(camera);
  std::vector<Evidence> evidence(psi_in_camera.size(), Evidence::kPresent);
  std::vector<std::size_t> open;
  Points open_in_camera;
  for (std::size_t i = 0; i < evidence.size(); ++i) {
    if (explained[i] != 0) continue;
    evidence[i] = Evidence::kUnobserved;
    if (!volume.contains(psi_in_camera[i])) continue;
    open.push_back(i);
    open_in_camera.push_back(psi_in_camera[i]);
  }
  const std::vector<Evidence> classified = classify_unexplained(open_in_camera, view, measured);
  for (std::size_t i = 0; i < open.size(); ++i) evidence[open[i]] = classified[i];
  return evidence;
}

/// Which of these pixels of the view an earlier view saw through.
std::vector<std::uint8_t> PointTest::find_seen_through(const std::vector<int>& pixels, const PreparedView& view,
                                                       const PreparedView& earlier) const {
  const Rigid3f earlier_from_view(earlier.frame.world_from_camera.inverse() * view.frame.world_from_camera);
  const FrustumLimits volume = view_volume(earlier.frame.camera);
  std::vector<std::size_t> positions;
  Points in_earlier;
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    const Eigen::Vector3f p = earlier_from_view * view.cloud.point(static_cast<std::size_t>(pixels[i]));
    if (!volume.contains(p)) continue;
    positions.push_back(i);
    in_earlier.push_back(p);
  }
  const SurfaceEvidence evidence =
      classify_surface({.points = in_earlier}, Rigid3::identity(), {earlier.frame.camera, earlier.frame.depth_m},
                       {.margin = {options_.occlusion_margin_m, options_.occlusion_sigmas},
                        .window_radius_px = options_.window_radius_px,
                        .num_threads = num_threads_});
  std::vector<std::uint8_t> seen_through(pixels.size());
  for (std::size_t i = 0; i < positions.size(); ++i)
    seen_through[positions[i]] = evidence.points[i] == Evidence::kSeenThrough ? 1 : 0;
  return seen_through;
}

std::vector<int> PointTest::keep_seen_through(std::vector<int> pixels, const PreparedView& view,
                                              std::span<const PreparedView* const> earlier_views) const {
  std::vector<int> kept;
  for (const PreparedView* earlier : earlier_views) {
    const std::vector<std::uint8_t> seen_through = find_seen_through(pixels, view, *earlier);
    std::vector<int> open;  // Not yet seen through.
    for (std::size_t i = 0; i < pixels.size(); ++i) (seen_through[i] != 0 ? kept : open).push_back(pixels[i]);
    pixels = std::move(open);
  }
  std::sort(kept.begin(), kept.end());
  return kept;
}

}  // namespace

PointChanges find_point_changes(const PreviousScene& previous, const PreparedView& view,
                                std::span<const PreparedView* const> earlier_views, const PointTestOptions& options,
                                int num_threads) {
  const PointTest test(options, num_threads);
  // All in the camera frame: moving Psi there is cheaper than moving the view's points to the world.
  const Rigid3 camera_from_world = view.frame.world_from_camera.inverse();
  const Points sparse_in_camera = transform_points(camera_from_world, previous.sparse_in_world.points, num_threads);
  const bool is_sparse = &previous.in_world == &previous.sparse_in_world;
  const Points dense_in_camera =
      is_sparse ? Points{} : transform_points(camera_from_world, previous.in_world.points, num_threads);

  PointChanges changes;
  Image<std::uint8_t> explained_pixels(view.cloud.width(), view.cloud.height());
  const std::vector<Evidence> evidence =
      test.classify_previous(sparse_in_camera, view, is_sparse ? &explained_pixels : nullptr);
  for (std::size_t i = 0; i < evidence.size(); ++i) {
    ++changes.evidence_count[static_cast<std::size_t>(evidence[i])];
    if (evidence[i] == Evidence::kSeenThrough) changes.removed.push_back(static_cast<int>(i));
  }
  changes.novel = test.find_unexplained(is_sparse ? sparse_in_camera : dense_in_camera, view, explained_pixels);
  changes.num_explained = count_valid(view.cloud.z) - changes.novel.size();
  if (options.novel_needs_free_space && !earlier_views.empty())
    changes.novel = test.keep_seen_through(std::move(changes.novel), view, earlier_views);
  return changes;
}

}  // namespace resight
