// SPDX-License-Identifier: Apache-2.0
#include "resight/report/internal/json_values.hpp"

#include "resight/core/json_text.hpp"

namespace resight::report {

using Json = nlohmann::ordered_json;

Json score_json(const RecognitionScore& score) {
  // The writer turns NaN into null.
  return {{"true_positives", score.true_positives},
          {"false_positives", score.false_positives},
          {"false_negatives", score.false_negatives},
          {"precision", score.precision()},
          {"recall", score.recall()},
          {"f_score", score.f_score()}};
}

Json pose_json(const Rigid3& pose) {
  Json rotation = Json::array();
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) rotation.push_back(pose.rotation(row, column));
  }
  return {{"rotation", rotation},
          {"translation_m", {pose.translation.x(), pose.translation.y(), pose.translation.z()}}};
}

std::string to_text(const Json& json) { return to_json_text(json, kIndentedJson) + "\n"; }

}  // namespace resight::report
