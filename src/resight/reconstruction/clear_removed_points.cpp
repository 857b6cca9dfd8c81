// SPDX-License-Identifier: Apache-2.0
#include <limits>

#include "resight/changes/view_difference.hpp"
#include "resight/core/check.hpp"
#include "resight/reconstruction/integration.hpp"

namespace resight {
namespace {

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

/// Pixels whose point lies within the tolerance of a removed point.
std::vector<int> find_removed_pixels(const PreparedView& view, const PointCloud& removed_in_world, double tolerance_m,
                                     int num_threads) {
  const PointCloud removed_in_camera =
      transform(view.frame.world_from_camera.inverse(),
                PointCloud{.points = removed_in_world.points, .normals = {}, .colors = {}});
  return find_pixels_near(removed_in_camera.points, view.cloud, view.frame.camera, tolerance_m, num_threads);
}

void clear_pixel(PreparedView& view, std::size_t i) {
  view.frame.depth_m[i] = kNaN;
  OrganizedCloud& cloud = view.cloud;
  for (Image<float>* image : {&cloud.x, &cloud.y, &cloud.z}) (*image)[i] = kNaN;
  if (!cloud.nx.empty())
    for (Image<float>* image : {&cloud.nx, &cloud.ny, &cloud.nz}) (*image)[i] = kNaN;
  // The noise of a point depends only on the point and its normal, so that the noise of all other points stays valid.
  for (Image<float>* image : {&view.noise.lateral_m, &view.noise.axial_m, &view.noise.normal_m}) (*image)[i] = kNaN;
}

}  // namespace

PreparedView clear_removed_points(PreparedView view, const PointCloud& removed_in_world, double tolerance_m,
                                  const PrepareViewOptions& prepare) {
  check_positive("tolerance_m", tolerance_m);
  prepare.check();
  require(view.frame.depth_m.size() == view.cloud.z.size() && view.noise.axial_m.size() == view.cloud.z.size(),
          "clear_removed_points: the view is not prepared (its images differ in size from its cloud)");
  if (removed_in_world.empty()) return view;
  const auto pixels = find_removed_pixels(view, removed_in_world, tolerance_m, prepare.num_threads);
  if (pixels.empty()) return view;
  for (const int i : pixels) clear_pixel(view, static_cast<std::size_t>(i));
  update_edge_distance(view.frame.depth_m, pixels, prepare.edges, view.edge_distance_px);
  return view;
}

}  // namespace resight
