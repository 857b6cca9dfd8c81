// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <nlohmann/json.hpp>

#include "resight/evaluation/recognition_score.hpp"

namespace resight::report {

/// Counts, precision, recall and F of a score. What is not defined, as precision without a detection, is null.
[[nodiscard]] nlohmann::ordered_json score_json(const RecognitionScore& score);

}  // namespace resight::report
