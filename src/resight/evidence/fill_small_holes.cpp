// SPDX-License-Identifier: Apache-2.0
#include "resight/evidence/fill_small_holes.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace resight {
namespace {

constexpr int kMinNeighbors = 5;

float median_of_neighbors(const Image<float>& depth_m, int u, int v) {
  std::array<float, 8> values;
  int count = 0;
  for (int dv = -1; dv <= 1; ++dv)
    for (int du = -1; du <= 1; ++du)
      if (depth_m.contains(u + du, v + dv) && !std::isnan(depth_m(u + du, v + dv)))
        values[count++] = depth_m(u + du, v + dv);
  if (count < kMinNeighbors) return std::numeric_limits<float>::quiet_NaN();
  std::nth_element(values.begin(), values.begin() + count / 2, values.begin() + count);
  return values[count / 2];
}

}  // namespace

Image<float> fill_small_holes(const Image<float>& depth_m) {
  Image<float> filled = depth_m;
  for (int v = 0; v < depth_m.height(); ++v)
    for (int u = 0; u < depth_m.width(); ++u)
      if (std::isnan(depth_m(u, v))) filled(u, v) = median_of_neighbors(depth_m, u, v);
  return filled;
}

}  // namespace resight
