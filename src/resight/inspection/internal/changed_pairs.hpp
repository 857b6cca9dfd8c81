// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <map>
#include <vector>

#include "resight/core/image.hpp"
#include "resight/geometry/rigid3.hpp"
#include "resight/inspection/measure_sequence.hpp"

namespace resight::inspection {

/// Depth in metres, by the number of the view.
using DepthOfViews = std::map<int, Image<float>>;

/// Sets ViewPair::shows_change where something has moved between the views, and has most of the texture: some of the
/// other matches agree with the given poses, and nearly as much of the depth as with the motion of the matches.
/// `poses`: of all views.
void mark_changed_pairs(const std::vector<Rigid3>& poses, const DepthOfViews& depths_m, SequenceMeasurements& measured);

}  // namespace resight::inspection
