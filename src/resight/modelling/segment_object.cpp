// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "resight/core/check.hpp"
#include "resight/modelling/object_region.hpp"
#include "resight/sensor/pixel_components.hpp"

namespace resight {
namespace {

constexpr int kMinNeighbors = 3;  // Of 8. A pixel with fewer is noise above the support.

void remove_specks(Image<std::uint8_t>& mask) {
  const Image<std::uint8_t> before = mask;
  for (int v = 0; v < mask.height(); ++v)
    for (int u = 0; u < mask.width(); ++u) {
      if (before(u, v) == 0) continue;
      int neighbors = -1;
      for (int y = std::max(0, v - 1); y <= std::min(mask.height() - 1, v + 1); ++y)
        for (int x = std::max(0, u - 1); x <= std::min(mask.width() - 1, u + 1); ++x) neighbors += before(x, y) != 0;
      if (neighbors < kMinNeighbors) mask(u, v) = 0;
    }
}

}  // namespace

void SegmentObjectOptions::check() const {
  check_positive("SegmentObjectOptions.min_height_m", min_height_m);
  check_positive("SegmentObjectOptions.max_jump_m", max_jump_m);
  check_in_range("SegmentObjectOptions.max_gap_px", max_gap_px, 1, 32);
  check_in_range("SegmentObjectOptions.min_component_share", min_component_share, 0, 1);
}

Image<std::uint8_t> segment_object(const OrganizedCloud& cloud, const ObjectRegion& region,
                                   const SegmentObjectOptions& options) {
  options.check();
  Image<std::uint8_t> mask(cloud.width(), cloud.height(), 0);
  for (std::size_t i = 0; i < mask.size(); ++i) {
    if (!cloud.has_point(i)) continue;
    const Eigen::Vector3d p = cloud.point(i).cast<double>();
    const double height_m = region.plane.height_m(p);
    if (height_m < options.min_height_m || height_m > region.height_m) continue;
    if (region.axis_distance_m(p) <= region.radius_m) mask[i] = 255;
  }
  remove_specks(mask);
  const auto components = find_pixel_components(cloud, mask, options.max_gap_px, options.max_jump_m);
  std::size_t largest = 0;
  for (const auto& component : components) largest = std::max(largest, component.size());
  for (const auto& component : components)
    if (static_cast<double>(component.size()) < options.min_component_share * static_cast<double>(largest))
      for (const int i : component) mask[static_cast<std::size_t>(i)] = 0;
  return mask;
}

}  // namespace resight
