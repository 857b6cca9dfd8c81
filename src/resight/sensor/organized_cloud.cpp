// SPDX-License-Identifier: Apache-2.0
#include "resight/sensor/organized_cloud.hpp"

#include <vector>

#include "resight/core/check.hpp"

namespace resight {

OrganizedCloud back_project(const Camera& camera, const Image<float>& depth_m) {
  require(camera.is_valid(), "back_project: invalid intrinsics (size and focal lengths must be positive and finite)");
  require(depth_m.width() == camera.width && depth_m.height() == camera.height,
          "back_project: the depth image must have the size of the camera image");
  const int width = camera.width;
  const int height = camera.height;
  std::vector<float> x_over_z(static_cast<std::size_t>(width));
  for (int u = 0; u < width; ++u) x_over_z[u] = static_cast<float>((u - camera.cx) / camera.fx);

  OrganizedCloud cloud{Image<float>(width, height), Image<float>(width, height), depth_m, {}, {}, {}};
  for (int v = 0; v < height; ++v) {
    const auto y_over_z = static_cast<float>((v - camera.cy) / camera.fy);
    const float* z = depth_m.row(v).data();
    float* x = cloud.x.row(v).data();
    float* y = cloud.y.row(v).data();
    for (int u = 0; u < width; ++u) {  // NaN depth makes x and y NaN
      x[u] = x_over_z[u] * z[u];
      y[u] = y_over_z * z[u];
    }
  }
  return cloud;
}

PointCloud to_point_cloud(const OrganizedCloud& cloud, const Image<Rgb8>* color, bool require_normal,
                          std::vector<int>* pixels) {
  const std::size_t size = cloud.z.size();
  require(color == nullptr || color->size() == size,
          "to_point_cloud: the colour image must have the size of the cloud");
  const bool has_normals = !cloud.nx.empty();
  require(has_normals || !require_normal, "to_point_cloud: normals are required, but were not computed");

  std::vector<int> chosen;
  for (std::size_t i = 0; i < size; ++i)
    if (cloud.has_point(i) && (!require_normal || cloud.has_normal(i))) chosen.push_back(static_cast<int>(i));

  PointCloud result;
  result.points.reserve(chosen.size());
  for (const int i : chosen) result.points.push_back(cloud.point(i));
  if (has_normals) {
    result.normals.reserve(chosen.size());
    for (const int i : chosen) result.normals.push_back(cloud.normal(i));
  }
  if (color != nullptr) {
    result.colors.reserve(chosen.size());
    for (const int i : chosen) result.colors.push_back((*color)[i]);
  }
  if (pixels != nullptr) *pixels = std::move(chosen);
  return result;
}

}  // namespace resight
