// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <optional>

#include "resight/evaluation/match_detections.hpp"
#include "resight/recognition/recognition_trace.hpp"
#include "resight/verification/hypothesis_evidence.hpp"

namespace resight {

/// The first stage after which no correct hypothesis of an object was left, in the order of the stages.
enum class LossStage : std::uint8_t {
  kNoKeypoints,  ///< Too few keypoints on its visible part to form a group.
  /// Enough keypoints, but too few of them matched to the right place of the right model.
  kNoMatches,
  kNoGroup,       ///< Right correspondences, but no hypothesis of this object near it.
  kWrongPose,     ///< A hypothesis at the place, but with too large an error.
  kClusteredOut,  ///< A correct hypothesis that clustering merged into a wrong one.
  /// A correct hypothesis after clustering that was not rejected: excluded by the changes, left out by a deadline, or
  /// accepted and matched to another ground-truth object, or too unlikely to be reported (detections.min_score).
  kCalledAbsent,
  kRefinedAway,  ///< A correct hypothesis that the refinement moved beyond the limits.
  kRejected,     ///< A correct hypothesis that the verification rejected.
};
/// Name of the stage, as in the reports.
[[nodiscard]] const char* to_string(LossStage stage);

/// Analysis of one object that was not found.
struct Loss {
  LossStage stage = LossStage::kNoKeypoints;
  /// SIFT and SHOT keypoints within keypoint_distance_m of the model's surface at the true pose.
  int num_keypoints = 0;
  int num_correspondences = 0;  ///< Of this object in this view.
  /// Correspondences that the true pose maps to within keypoint_distance_m.
  int num_right = 0;
  /// Error of the nearest hypothesis of this object at the latest stage.
  std::optional<PoseDifference> best;
  /// Of the best refined hypothesis; for kRejected and kRefinedAway only.
  std::optional<HypothesisEvidence> evidence;
  int verified = -1;  ///< Index of that hypothesis in RecognitionTrace::verified; -1: none.
};

struct FindLossOptions {
  double keypoint_distance_m = 0.01;
  int min_group_size = 5;  ///< Fewer keypoints or right correspondences make no group.
  MatchDetectionsOptions match{};
};

/// Finds the stage at which a ground-truth object was lost, from the trace of a view. Keypoints and correspondences are
/// those of this view, hypotheses those of the window. Throws std::invalid_argument for an object that is not in the
/// library.
[[nodiscard]] Loss find_loss(const GroundTruthObject& truth, const Rigid3& world_from_camera,
                             const RecognitionTrace& trace, const ModelLibrary& library,
                             const FindLossOptions& options = {});

}  // namespace resight
