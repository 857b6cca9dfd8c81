// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <span>
#include <string>
#include <vector>

#include "resight/evaluation/recognition_score.hpp"
#include "resight/geometry/rigid3.hpp"
#include "resight/models/object_model.hpp"
#include "resight/models/pose_distance.hpp"
#include "resight/sensor/sequence.hpp"

namespace resight {

/// An object that a recogniser, ours or another, reports in one view.
struct DetectedObject {
  std::string object;  ///< Name of the model.
  Rigid3 camera_from_object;
  double score = 0;
};

/// Criteria of a correct detection. The defaults follow the paper's evaluation as published in its later code; the
/// paper states none.
struct MatchDetectionsOptions {
  double max_center_distance_m = 0.05;  ///< Between the objects' centres (ObjectModel::center), not their origins.
  double max_rotation_rad = 0.523599;   ///< Geodesic, over the object's symmetries; 30 deg.
  /// Ground truth seen less than this is neither hit nor miss. Unknown (NaN) counts as seen.
  double min_visible_share = 0.05;
  void check() const;  ///< Throws std::invalid_argument: field, value, rule.
};

/// The strict limits: 1 cm and 10 deg.
[[nodiscard]] MatchDetectionsOptions strict_match_options();

/// Whether the difference is within both limits (inclusive).
[[nodiscard]] bool is_within(const PoseDifference& difference, const MatchDetectionsOptions& options);

/// A detection and the ground truth it is matched to.
struct DetectionMatch {
  int detection = -1;
  int truth = -1;
  PoseDifference difference;
};

/// Score of one view. Each detection and each ground-truth object is in exactly one list.
struct MatchDetectionsResult {
  RecognitionScore score;
  std::vector<DetectionMatch> matches;  ///< True positives, by ascending detection.
  std::vector<int> false_positives;     ///< Detections, ascending.
  /// Ascending detections matched to an object that is too occluded to count.
  std::vector<int> ignored_detections;
  std::vector<int> false_negatives;  ///< Ascending indices of the ground truth.
  /// Ascending indices of ground truth with a visible share below min_visible_share.
  std::vector<int> ignored_truth;
  /// Ground truth of objects that are not in the library. They cannot be found and do not count.
  std::vector<int> unknown_truth;
};

/// Scores the detections of one view against its ground truth (both in the camera frame).
///
/// A pair is possible if object, centre and rotation agree. Pairs are chosen one to one per object, such that as many
/// objects as possible are found and, among those choices, the sum of differences (centre and rotation, relative to
/// their limits) is minimal. The assignment is optimal, not greedy, so that the order of the input does not matter.
/// Remaining detections are ignored if they match an object that is too occluded to count. A visible object with a
/// wrong pose counts twice: as a false negative and as a false positive. Throws std::invalid_argument for a detection
/// whose object is not in the library.
[[nodiscard]] MatchDetectionsResult match_detections(std::span<const GroundTruthObject> truth,
                                                     std::span<const DetectedObject> detections,
                                                     const ModelLibrary& library,
                                                     const MatchDetectionsOptions& options = {});

}  // namespace resight
