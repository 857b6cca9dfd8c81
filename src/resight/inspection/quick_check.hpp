// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <vector>

#include "resight/inspection/finding.hpp"
#include "resight/sensor/sequence.hpp"

namespace resight {

/// Faults that the first view shows, and gross faults of poses that it and one later view show by their depths: other
/// conventions and other units are tried on few pixels. Takes some hundredths of a second. Views that cannot be read
/// are left to others. `uses_poses`: whether the given poses matter.
[[nodiscard]] std::vector<Finding> check_quickly(const Sequence& sequence, bool uses_poses);

}  // namespace resight
