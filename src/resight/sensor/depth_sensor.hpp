// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <span>
#include <string_view>

#include "resight/geometry/depth_noise.hpp"

namespace resight {

/// A kind of depth camera.
struct DepthSensor {
  std::string_view name;  ///< As on the command line.
  DepthNoise noise;
  std::string_view source;  ///< Of the noise.
};

/// All kinds; the first one is taken where nothing says which it is.
[[nodiscard]] std::span<const DepthSensor> depth_sensors();
/// By its name; null if there is none of it.
[[nodiscard]] const DepthSensor* find_depth_sensor(std::string_view name);
/// By a text that names the camera or its driver, such as the topics of a recording; null if it does not. The name of a
/// camera counts more than that of a driver.
[[nodiscard]] const DepthSensor* detect_depth_sensor(std::string_view text);

}  // namespace resight
