// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <vector>

#include "resight/inspection/finding.hpp"
#include "resight/inspection/measure_sequence.hpp"

namespace resight {

/// What is wrong with a sequence, in the order in which it should be repaired. A fault that explains others is reported
/// alone: without depth nothing can be said about poses.
[[nodiscard]] std::vector<Finding> find_faults(const SequenceMeasurements& measured);

/// What is no fault but worth knowing, one line each: a camera that does not move, poses that could not be checked.
[[nodiscard]] std::vector<std::string> list_facts(const SequenceMeasurements& measured);

/// What could not be measured, one line each. A sequence without faults is sound only if this is empty. `knows_sizes`:
/// the sizes of known objects were compared with those in the views.
[[nodiscard]] std::vector<std::string> list_unmeasured(const SequenceMeasurements& measured, bool knows_sizes = false);

/// Faults that a single view shows without any other: cheap enough for every start of the program.
[[nodiscard]] std::vector<Finding> find_view_faults(const RgbdFrame& frame);

}  // namespace resight
