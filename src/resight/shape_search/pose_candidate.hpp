// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>

#include "resight/geometry/rigid3.hpp"
#include "resight/shape_search/pose_probe.hpp"

namespace resight {

/// A rough pose that passed the first test.
struct PoseCandidate {
  int object = -1;  ///< Index into the library.
  float score = 0;  ///< first_test_score() of it.
  Rigid3f camera_from_object{Rigid3{}};
};

/// In [-1, 1): share of the samples that the view confirms, less what speaks against the pose. Hidden ones count
/// little.
[[nodiscard]] inline float first_test_score(const SampleCounts& c) {
  constexpr float kHiddenWeight = 0.4F;
  constexpr float kPrior = 3;
  return static_cast<float>(c.confirmed - c.off_color - c.through) /
         (static_cast<float>(c.confirmed + c.through) + kHiddenWeight * static_cast<float>(c.hidden) + kPrior);
}

/// The pose as a candidate if the first test does not give up on it and its score is at least `min_score`.
[[nodiscard]] inline std::optional<PoseCandidate> first_test(int object, const ProbeModel& model,
                                                             const Rigid3f& camera_from_object, const PoseProbe& probe,
                                                             const CountSamplesOptions& options, double min_score) {
  const SampleCounts counts = probe.count(model, camera_from_object, options);
  const float score = first_test_score(counts);
  if (counts.gave_up || score < static_cast<float>(min_score)) return std::nullopt;
  return PoseCandidate{object, score, camera_from_object};
}

}  // namespace resight
