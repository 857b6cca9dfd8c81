// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <span>
#include <vector>

#include "resight/hypotheses/hypothesis.hpp"
#include "resight/shape_search/pose_candidate.hpp"
#include "resight/shape_search/shape_search.hpp"

namespace resight {

/// Poses of an object, each from two of its matches (scene side in the camera frame) that keep their distance and the
/// directions of their normals; those that pass the first test. Two are enough, where a group that speaks for itself
/// needs five: here the whole object speaks.
[[nodiscard]] std::vector<PoseCandidate> poses_of_match_pairs(std::span<const Correspondence> matches, int object,
                                                              const SampledModel& model, const PoseScorer& scorer,
                                                              const ShapeSearchOptions& options);

/// The matches of SIFT that agree with a pose (scene_from_object): within a distance, each keypoint of model and scene
/// in the nearest only. Ascending. They speak for the print; that the shape agrees is known of such a pose.
[[nodiscard]] std::vector<int> agreeing_matches(std::span<const Correspondence> matches,
                                                const Rigid3& scene_from_object, double max_distance_m);

}  // namespace resight
