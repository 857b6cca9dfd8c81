// SPDX-License-Identifier: Apache-2.0
#include "resight/report/outline.hpp"

#include "resight/report/internal/drawing.hpp"

namespace resight {

std::vector<std::vector<Pixel>> find_outline(const Camera& camera, const Rigid3& camera_from_object,
                                             const PointCloud& surface, double voxel_m) {
  std::vector<std::vector<Pixel>> outline;
  for (const auto& contour : report::project_outline(camera, camera_from_object, surface, voxel_m)) {
    auto& line = outline.emplace_back();
    for (const cv::Point& point : contour) line.push_back({point.x, point.y});
  }
  return outline;
}

}  // namespace resight
