// SPDX-License-Identifier: Apache-2.0
#pragma once
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

}  // namespace resight
