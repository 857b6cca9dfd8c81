// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "resight/core/image.hpp"
#include "resight/inspection/finding.hpp"
#include "resight/inspection/measure_sequence.hpp"

namespace resight::app {

/// A picture of the view that shows a finding: its depth (near is bright) for faults of depth, its colours with the
/// contours of the depth (red) for shifts, and for faults of poses the places where matches are (green) and where the
/// given poses put them (red). Otherwise its colours.
[[nodiscard]] Image<Rgb8> draw_finding(const Finding& finding, const SequenceMeasurements& measured,
                                       const Sequence& sequence);

}  // namespace resight::app
