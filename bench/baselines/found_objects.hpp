// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <vector>

#include "stage_input.hpp"

namespace resight::bench {

struct PosedObject {
  int object = -1;  ///< Index into the library.
  Rigid3 camera_from_object;
};

/// Number of true objects with one of these poses within 5 cm and 30 deg, and number of right poses. Without ground
/// truth: the number of poses.
[[nodiscard]] std::string rate_proposals(const StageInput& input, const std::vector<PosedObject>& posed);

/// Precision and recall of detections, one to one. Without ground truth: their number.
[[nodiscard]] std::string rate_detections(const StageInput& input, const std::vector<PosedObject>& posed);

}  // namespace resight::bench
