// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>

#include "resight/geometry/rigid3.hpp"
#include "resight/shape_search/pose_scorer.hpp"

namespace resight {

/// A rough pose that passed the coarse test.
struct PoseCandidate {
  int object = -1;  ///< Index into the library.
  float score = 0;  ///< SampleCounts::score() of it.
  Rigid3f camera_from_object{Rigid3{}};
};

/// Least score of the coarse test. 1: all samples are confirmed.
inline constexpr double kMinCoarseScore = 0.2;

/// The pose as a candidate if the coarse test does not give up on it and its score is high enough.
[[nodiscard]] inline std::optional<PoseCandidate> test_coarsely(int object, const SampledModel& model,
                                                                const Rigid3f& camera_from_object,
                                                                const PoseScorer& scorer) {
  const SampleCounts counts = scorer.score_coarse(model, camera_from_object, {}, kMinCoarseScore);
  const float score = counts.score();
  if (counts.gave_up || score < static_cast<float>(kMinCoarseScore)) return std::nullopt;
  return PoseCandidate{object, score, camera_from_object};
}

}  // namespace resight
