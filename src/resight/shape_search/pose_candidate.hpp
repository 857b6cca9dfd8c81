// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>

#include "resight/geometry/rigid3.hpp"
#include "resight/shape_search/pose_scorer.hpp"

namespace resight {

/// A rough pose that passed the first test.
struct PoseCandidate {
  int object = -1;  ///< Index into the library.
  float score = 0;  ///< SampleCounts::score() of it.
  Rigid3f camera_from_object{Rigid3{}};
};

/// Least score of the first test. 1: all samples are confirmed.
inline constexpr double kMinCoarseScore = 0.2;

/// The pose as a candidate if the first test does not give up on it and its score is high enough.
[[nodiscard]] inline std::optional<PoseCandidate> first_test(int object, const SampledModel& model,
                                                             const Rigid3f& camera_from_object,
                                                             const PoseScorer& probe) {
  const SampleCounts counts = probe.count(model, camera_from_object, {}, kMinCoarseScore);
  const float score = counts.score();
  if (counts.gave_up || score < static_cast<float>(kMinCoarseScore)) return std::nullopt;
  return PoseCandidate{object, score, camera_from_object};
}

}  // namespace resight
