// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <nlohmann/json.hpp>
#include <string>

#include "resight/evaluation/recognition_score.hpp"
#include "resight/geometry/rigid3.hpp"

namespace resight::report {

/// Counts, precision, recall and F of a score. What is not defined, as precision without a detection, is null.
[[nodiscard]] nlohmann::ordered_json score_json(const RecognitionScore& score);

/// Rotation row by row, and translation in metres.
[[nodiscard]] nlohmann::ordered_json pose_json(const Rigid3& pose);

/// One value a line, indented by one blank. Broken UTF-8 is replaced.
[[nodiscard]] std::string to_text(const nlohmann::ordered_json& json);

}  // namespace resight::report
