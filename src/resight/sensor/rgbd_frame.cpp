// SPDX-License-Identifier: Apache-2.0
#include "resight/sensor/rgbd_frame.hpp"

#include <algorithm>
#include <cmath>

namespace resight {

Result<void> check_frame(const RgbdFrame& frame) {
  const auto fail = [&](const std::string& what) { return Error{"view '" + frame.name + "': " + what}; };
  const auto has_size = [&](const auto& image) {
    return image.width() == frame.camera.width && image.height() == frame.camera.height;
  };
  if (!frame.camera.is_valid()) return fail("invalid intrinsics (size and focal lengths must be positive and finite)");
  if (!has_size(frame.depth_m)) return fail("the depth image must have the size of the camera image");
  if (!has_size(frame.color)) return fail("the colour image must have the size of the depth image");
  if (!frame.world_from_camera.is_rigid())
    return fail("the camera pose is not a rigid motion (NaN, scale, shear or reflection)");
  for (const float z : frame.depth_m.data())
    if (!std::isnan(z) && std::isnan(depth_or_none(z)))
      return fail("the depth contains zero, negative or infinite values, or some beyond 10 km (wrong unit?)");
  return {};
}

bool is_grey(const Image<Rgb8>& color) {
  constexpr int kMaxDifference = 2;  // Grey images compressed in colour. The noise of a colour camera is more.
  return std::ranges::all_of(color.data(), [](const Rgb8& c) {
    return std::max({c.r, c.g, c.b}) - std::min({c.r, c.g, c.b}) <= kMaxDifference;
  });
}

std::size_t count_valid(const Image<float>& depth_m) {
  return static_cast<std::size_t>(std::ranges::count_if(depth_m.data(), [](float z) { return !std::isnan(z); }));
}

}  // namespace resight
