// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "resight/inspection/measure_sequence.hpp"

namespace resight {

/// Tries readings of the given poses on the matched pairs of views. `measured` needs pairs, camera and unit.
[[nodiscard]] Result<PoseMeasurements> measure_poses(const Sequence& sequence, const SequenceMeasurements& measured);

}  // namespace resight
