// SPDX-License-Identifier: Apache-2.0
#include "resight/report/internal/score_json.hpp"

namespace resight::report {

nlohmann::ordered_json score_json(const RecognitionScore& score) {
  // The writer turns NaN into null.
  return {{"true_positives", score.true_positives},
          {"false_positives", score.false_positives},
          {"false_negatives", score.false_negatives},
          {"precision", score.precision()},
          {"recall", score.recall()},
          {"f_score", score.f_score()}};
}

}  // namespace resight::report
