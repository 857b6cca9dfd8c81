// SPDX-License-Identifier: Apache-2.0
#include "resight/sensor/prepared_view.hpp"

#include <limits>

#include "resight/sensor/reduce_frame.hpp"
#include "resight/sensor/surface_color.hpp"

namespace resight {
namespace {

constexpr float kInvalid = std::numeric_limits<float>::quiet_NaN();

void drop_nearer_depth(double min_depth_m, Image<float>& depth_m) {
  const auto limit_m = static_cast<float>(min_depth_m);
  for (float& z : depth_m.data())
    if (z < limit_m) z = kInvalid;
}

void drop_farther_points(double max_depth_m, OrganizedCloud& cloud) {
  const auto limit_m = static_cast<float>(max_depth_m);
  for (std::size_t i = 0; i < cloud.z.size(); ++i) {
    if (!(cloud.z[i] > limit_m)) continue;
    for (Image<float>* image : {&cloud.x, &cloud.y, &cloud.z, &cloud.nx, &cloud.ny, &cloud.nz}) (*image)[i] = kInvalid;
  }
}

}  // namespace

int find_reduction(const Camera& camera, const PrepareViewOptions& options) {
  return options.max_pixels ? find_reduction(camera, *options.max_pixels) : 1;
}

PreparedView prepare_view(RgbdFrame frame, const PrepareViewOptions& options) {
  options.check();
  if (const Result<void> valid = check_frame(frame); !valid) throw std::invalid_argument(valid.error().message);
  PreparedView view;
  const int divisor = find_reduction(frame.camera, options);
  view.frame = divisor > 1 ? reduce_frame(frame, divisor) : std::move(frame);
  if (options.min_depth_m) drop_nearer_depth(*options.min_depth_m, view.frame.depth_m);
  view.cloud = back_project(view.frame.camera, view.frame.depth_m);
  ComputeNormalsOptions normals = options.normals;
  normals.num_threads = options.num_threads;
  compute_normals(view.cloud, normals);
  if (options.max_depth_m) drop_farther_points(*options.max_depth_m, view.cloud);
  view.edge_distance_px =
      find_edge_distance(find_depth_edges(view.frame.depth_m, options.edges), options.edges.max_distance_px);
  view.noise = model_noise(view.cloud, view.frame.camera, options.num_threads);
  view.is_grey = is_grey(view.frame.color);
  if (options.color_width_m)
    view.averaged_color = average_over_surface(view.frame.color, view.frame.camera, view.cloud.z,
                                               *options.color_width_m, options.num_threads);
  return view;
}

}  // namespace resight
