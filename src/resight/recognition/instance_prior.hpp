// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <vector>

#include "resight/recognition/scene_update.hpp"

namespace resight {

/// Lowers the scores of several detections of one object: second instances are rare, and look-alikes pass for them.
/// The score s of a detection is the probability that it is right, regardless of the others. Any subset of the
/// detections of an object can be the right one. Its probability is proportional to
///
///   further_instance_odds^max(0, |subset| - 1) * product of s / (1 - s) over the subset.
///
/// The new score of a detection is the sum of the probabilities of all subsets that contain it. An object that is
/// detected once keeps its score; with odds of 1, all do.
void apply_instance_prior(std::vector<Detection>& detections, double further_instance_odds);

}  // namespace resight
