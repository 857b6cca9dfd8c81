// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include "resight/core/result.hpp"
#include "resight/core/timing.hpp"
#include "resight/evaluation/change_points.hpp"
#include "resight/evaluation/event_score.hpp"
#include "resight/evaluation/recognition_score.hpp"
#include "resight/recognition/scene_update.hpp"

namespace resight {

/// A ground-truth object in one view, and its result.
struct EvaluatedTruth {
  std::string object;
  int instance = 0;
  double visible_share = std::numeric_limits<double>::quiet_NaN();  ///< NaN = unknown.
  double distance_m = 0;                                            ///< From the camera to the object's centre.
  bool counts = true;           ///< False: too occluded to count as found or missed.
  bool found = false;           ///< Within the loose limits (5 cm, 30 deg).
  bool found_strictly = false;  ///< Within the strict limits (1 cm, 10 deg).
  double center_error_m = std::numeric_limits<double>::quiet_NaN();  ///< NaN if missed.
  double rotation_error_rad = std::numeric_limits<double>::quiet_NaN();
  std::string lost_at;  ///< Stage at which a missed object was lost (LossStage); empty = found, or not analysed.
};

/// Verdict of the ground truth on a detection. kIgnored: matched to an object that is too occluded to count, or outside
/// the image.
enum class DetectionVerdict : std::uint8_t { kCorrect, kFalsePositive, kGhost, kIgnored };
/// Name of the verdict, as in the stored runs.
[[nodiscard]] std::string_view to_string(DetectionVerdict verdict);

/// A detection in one view, with its verdict.
struct EvaluatedDetection {
  std::string object;
  Rigid3 camera_from_object;
  double score = 0;
  DetectionVerdict verdict = DetectionVerdict::kFalsePositive;
};

/// Scores, detections, counts and times of one view.
struct EvaluatedView {
  std::string name;
  std::vector<EvaluatedTruth> truth;
  std::vector<EvaluatedDetection> detections;
  RecognitionScore score;
  RecognitionScore strict_score;
  int num_detected_former_places = 0;  ///< count_detected_former_places().
  HypothesisCounts counts;
  ChangePointScores points;
  StageTimes times;
};

/// Result of one configuration on one sequence: the unit of an evaluation, stored and merged as a whole.
struct EvaluatedRun {
  std::string sequence;
  std::string preset;
  int num_previous_views = 0;  ///< K.
  bool is_clustered = true;
  std::string fingerprint;  ///< Hash of program, settings, models, views and truth; results with another one are stale.
  int num_threads = 1;      ///< Number of threads while times were measured.
  /// Places that library objects left; ghosts are counted per former place.
  int num_former_places = 0;
  int num_published_places = 0;  ///< The same by the published rule: also those that may not have been left.
  /// Whether the ground truth lists changes and the preset detects them.
  bool has_changes = false;
  EventScore events;  ///< Only with has_changes.
  std::vector<EvaluatedView> views;

  [[nodiscard]] int num_ghosts() const;
};

/// Converts a run to JSON and back without loss. Parsing fails with an error that names `name`.
[[nodiscard]] std::string format_run(const EvaluatedRun& run);
[[nodiscard]] Result<EvaluatedRun> parse_run(std::string_view text, const std::string& name);

}  // namespace resight
