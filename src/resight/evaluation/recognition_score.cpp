// SPDX-License-Identifier: Apache-2.0
#include "resight/evaluation/recognition_score.hpp"

#include <limits>

namespace resight {
namespace {

double ratio_or_nan(int part, int whole) {
  return whole == 0 ? std::numeric_limits<double>::quiet_NaN() : static_cast<double>(part) / whole;
}

}  // namespace

double RecognitionScore::precision() const { return ratio_or_nan(true_positives, true_positives + false_positives); }

double RecognitionScore::recall() const { return ratio_or_nan(true_positives, true_positives + false_negatives); }

double RecognitionScore::f_score() const {
  return ratio_or_nan(2 * true_positives, 2 * true_positives + false_positives + false_negatives);
}

RecognitionScore& RecognitionScore::operator+=(const RecognitionScore& other) {
  true_positives += other.true_positives;
  false_positives += other.false_positives;
  false_negatives += other.false_negatives;
  return *this;
}

}  // namespace resight
