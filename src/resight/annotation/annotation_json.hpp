// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <nlohmann/json.hpp>
#include <optional>
#include <string_view>

#include "resight/annotation/annotation_document.hpp"

namespace resight::annotation {

/// 16 numbers, column by column.
[[nodiscard]] nlohmann::json pose_to_json(const Rigid3& pose);
[[nodiscard]] nlohmann::json point_to_json(const std::optional<Eigen::Vector3d>& point_m);

[[nodiscard]] nlohmann::json region_to_json(const RegionKey& region);
/// First pixel and number of pixels of each run in turn.
[[nodiscard]] nlohmann::json runs_to_json(const PixelRuns& runs);
/// None unless check_runs() accepts them.
[[nodiscard]] std::optional<PixelRuns> runs_from_json(const nlohmann::json& json);

/// None unless it is a pose of 16 finite numbers that can be repaired.
[[nodiscard]] std::optional<Rigid3> pose_from_json(const nlohmann::json& json);

[[nodiscard]] std::string_view to_text(RegionVerdict verdict);
[[nodiscard]] std::string_view to_text(AnnotatedEventKind kind);

}  // namespace resight::annotation
