// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <vector>

#include "resight/inspection/measure_sequence.hpp"

namespace resight {

/// Of all views. Fails with the error of the first one that cannot be read.
[[nodiscard]] Result<std::vector<Rigid3>> read_poses(const Sequence& sequence);

/// Tries readings of the given poses on the matched pairs of views. `measured` needs pairs, camera and unit.
[[nodiscard]] PoseMeasurements measure_poses(const std::vector<Rigid3>& poses, const SequenceMeasurements& measured);

}  // namespace resight
