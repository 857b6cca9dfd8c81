// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <optional>

#include "resight/evaluation/match_detections.hpp"
#include "resight/recognition/recognition_trace.hpp"

namespace resight {

/// The first stage after which nothing right was left of an object, in the order of the stages.
enum class LossStage : std::uint8_t {
  kNoKeypoints,   ///< Too few keypoints on what is seen of it to make a group.
  kNoMatches,     ///< Keypoints, but too few of them matched to the right place of the right model.
  kNoGroup,       ///< Right correspondences, but no hypothesis of this object near it.
  kWrongPose,     ///< A hypothesis at the place, but turned or shifted too much.
  kClusteredOut,  ///< A right hypothesis that clustering merged into a wrong one.
  kCalledAbsent,  ///< A right hypothesis that the changes excluded; with judge_absent, one that was accepted elsewhere.
  kRefinedAway,   ///< A right hypothesis that the verification's refinement moved out of tolerance.
  kRejected,      ///< A right hypothesis that the verification rejected.
};
[[nodiscard]] const char* to_string(LossStage stage);

/// What became of one object that was not found.
struct Loss {
  LossStage stage = LossStage::kNoKeypoints;
  int num_keypoints = 0;        ///< Of both kinds, within keypoint_distance_m of the model's surface at the true pose.
  int num_correspondences = 0;  ///< Of this object, in this view.
  int num_right = 0;            ///< Of these, those that the true pose maps within keypoint_distance_m.
  std::optional<PoseDifference> best;          ///< Of the nearest hypothesis of this object that got farthest.
  std::optional<HypothesisEvidence> evidence;  ///< Of the best right hypothesis; kRejected only.
};

struct FindLossOptions {
  double keypoint_distance_m = 0.01;
  int min_group_size = 5;  ///< Fewer keypoints or right correspondences make no group.
  MatchDetectionsOptions match{};
};

/// Looks through the trace of a view for the stage at which an object of its ground truth was lost. The keypoints and
/// correspondences are those of this view; the hypotheses those of the window. Throws std::invalid_argument for an
/// object that is not in the library.
[[nodiscard]] Loss find_loss(const GroundTruthObject& truth, const Rigid3& world_from_camera,
                             const RecognitionTrace& trace, const ModelLibrary& library,
                             const FindLossOptions& options = {});

}  // namespace resight
