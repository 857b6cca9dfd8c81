// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <span>
#include <string>
#include <vector>

#include "resight/evaluation/recognition_score.hpp"
#include "resight/geometry/rigid3.hpp"
#include "resight/io/sequence.hpp"
#include "resight/models/object_model.hpp"

namespace resight {

/// What a recogniser, ours or another, says of one view.
struct DetectedObject {
  std::string object;  ///< Name of the model.
  Rigid3 camera_from_object;
  double score = 0;
};

/// When a detection is right. The defaults are those of the paper's evaluation as its later public code has them; the
/// paper names none.
struct MatchDetectionsOptions {
  double max_center_distance_m = 0.05;  ///< Between the objects' centres (ObjectModel::center), not their origins.
  double max_rotation_rad = 0.523599;   ///< Geodesic, over the object's symmetries; 30 deg.
  double min_visible_share =
      0.05;            ///< Ground truth seen less than this is neither hit nor miss. Unknown (NaN) counts as seen.
  void check() const;  ///< Throws std::invalid_argument: field, value, rule.
};

/// The strict pair: 1 cm and 10 deg.
[[nodiscard]] MatchDetectionsOptions strict_match_options();

/// How far two poses of one object are apart.
struct PoseDifference {
  double center_distance_m = 0;
  double rotation_rad = 0;  ///< Over the object's symmetries.
};

/// Both poses in the same frame a. The centre is compared after the nearest symmetric equivalent has been chosen, so
/// that a symmetry axis beside the centroid does not add distance.
[[nodiscard]] PoseDifference compare_poses(const Rigid3& a_from_object, const Rigid3& reference_a_from_object,
                                           const ObjectModel& model);

/// Whether the difference is within both limits (boundary included).
[[nodiscard]] bool is_within(const PoseDifference& difference, const MatchDetectionsOptions& options);

/// A detection and the ground truth it is taken for.
struct DetectionMatch {
  int detection = -1;
  int truth = -1;
  PoseDifference difference;
};

/// One view, scored. Each detection and each ground truth is in exactly one of the lists that name its kind.
struct MatchDetectionsResult {
  RecognitionScore score;
  std::vector<DetectionMatch> matches;  ///< True positives, by ascending detection.
  std::vector<int> false_positives;     ///< Detections, ascending.
  std::vector<int> ignored_detections;  ///< Detections of a truth that is too hidden to count, ascending.
  std::vector<int> false_negatives;     ///< Truth, ascending.
  std::vector<int> ignored_truth;       ///< Truth seen less than min_visible_share, ascending.
  std::vector<int>
      unknown_truth;  ///< Truth of objects that are not in the library: nobody could find them, so they do not count.
};

/// Scores the detections of one view against the ground truth of the same view (camera frame both).
///
/// A pair is possible when object, centre and rotation agree. Pairs are chosen per object, one to one, so that as many
/// truths as possible are found and, among those choices, the summed difference (centre and rotation, each as a share
/// of its limit) is least: optimal, not greedy, so the order of the input does not matter. What is left over may still
/// be explained by a truth that is too hidden to count; it is then ignored. A visible truth with a wrong pose on it
/// costs twice: missed, and a false positive. Throws std::invalid_argument for a detection whose object is not in the
/// library.
[[nodiscard]] MatchDetectionsResult match_detections(std::span<const GroundTruthObject> truth,
                                                     std::span<const DetectedObject> detections,
                                                     const ModelLibrary& library,
                                                     const MatchDetectionsOptions& options = {});

}  // namespace resight
