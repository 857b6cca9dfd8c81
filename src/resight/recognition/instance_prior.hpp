// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <vector>

#include "resight/recognition/scene_update.hpp"

namespace resight {

/// Lowers the scores of detections of one object: a scene seldom holds a second instance, and a look-alike is taken for
/// one. The score s of a detection is its probability if it is alone. Each instance after the first has
/// `further_instance_odds` times its odds, so the n detections of an object, of which any subset can be right, have
///
///   P(subset) ~ further_instance_odds^max(0, |subset| - 1) * product of s / (1 - s) over the subset,
///
/// and the new score of a detection is the sum over the subsets that contain it. 1 changes nothing, nor does any value
/// change the score of an object that is detected once.
void apply_instance_prior(std::vector<Detection>& detections, double further_instance_odds);

}  // namespace resight
