// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <vector>

#include "resight/inspection/finding.hpp"
#include "resight/inspection/measure_sequence.hpp"

namespace resight::inspection {

/// With fewer matched pairs of views, their motion says too little.
inline constexpr std::size_t kMinComparedPairs = 3;

/// Adds faults that the motion between views shows: of poses, of their unit and time, of the intrinsics.
void add_pose_faults(const SequenceMeasurements& measured, std::vector<Finding>& findings);

}  // namespace resight::inspection
