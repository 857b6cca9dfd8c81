// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "resight/inspection/finding.hpp"
#include "resight/inspection/measure_sequence.hpp"

namespace resight::inspection {

/// With fewer matched pairs of views, their motion says too little.
inline constexpr std::size_t kMinComparedPairs = 3;

/// Why a unit of the depth that is off by less than ten would not show in the motion between views; none if it would.
[[nodiscard]] std::optional<std::string> why_unit_is_unmeasured(const SequenceMeasurements& measured);
/// The same of wrong poses, where enough pairs could be matched. Those that are all equal are checked by other means.
[[nodiscard]] std::optional<std::string> why_poses_are_unmeasured(const SequenceMeasurements& measured);
/// The same of a wrong focal length.
[[nodiscard]] std::optional<std::string> why_intrinsics_are_unmeasured(const SequenceMeasurements& measured);

/// Whether the poses explain the motion between views with the depth as it is: then its unit is right.
[[nodiscard]] bool is_unit_confirmed(const SequenceMeasurements& measured);
/// Adds faults that the motion between views shows: of poses, of their unit and time, of the intrinsics.
void add_pose_faults(const SequenceMeasurements& measured, std::vector<Finding>& findings);

}  // namespace resight::inspection
