// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <span>
#include <vector>

#include "resight/shape_search/pose_candidate.hpp"
#include "resight/shape_search/shape_search.hpp"

namespace resight {

/// Poses from pairs of matches (scene side in the camera frame) that preserve distance and normals, if they pass the
/// coarse test. Two matches suffice because the whole object is then scored; a group alone needs five.
[[nodiscard]] std::vector<PoseCandidate> poses_of_match_pairs(std::span<const Correspondence> matches, int object,
                                                              const SampledModel& model, const PoseScorer& scorer,
                                                              const ShapeSearchOptions& options);

/// The matches of SIFT that agree with a pose (scene_from_object): within a distance, each keypoint of model and scene
/// in the nearest only. Ascending. They support the texture; the shape is tested separately.
[[nodiscard]] std::vector<int> agreeing_matches(std::span<const Correspondence> matches,
                                                const Rigid3& scene_from_object, double max_distance_m);

}  // namespace resight
