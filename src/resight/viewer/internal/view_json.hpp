// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "resight/geometry/camera.hpp"
#include "resight/geometry/rigid3.hpp"

namespace resight::viewer {

using Json = nlohmann::ordered_json;

/// On one line; bytes that are not UTF-8 are replaced.
[[nodiscard]] std::string to_text(const Json& json);

/// A pose as a 4x4 matrix, column by column; null without one.
[[nodiscard]] Json matrix_json(const Rigid3& pose);
[[nodiscard]] Json matrix_json(const std::optional<Rigid3>& pose);

[[nodiscard]] Json camera_json(const Camera& camera);

/// Contours, each as a list of columns and rows.
[[nodiscard]] Json contours_json(const std::vector<std::vector<Pixel>>& contours);

}  // namespace resight::viewer
