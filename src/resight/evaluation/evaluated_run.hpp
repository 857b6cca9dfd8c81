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

/// A known object of the ground truth in one view, and what became of it.
struct EvaluatedTruth {
  std::string object;
  int instance = 0;
  double visible_share = std::numeric_limits<double>::quiet_NaN();  ///< NaN = unknown.
  double distance_m = 0;                                            ///< From the camera to its centre.
  bool counts = true;                                               ///< False: too hidden to be hit or miss.
  bool found = false;           ///< Within the loose pair of tolerances (5 cm, 30 deg).
  bool found_strictly = false;  ///< Within the strict pair (1 cm, 10 deg).
  double center_error_m = std::numeric_limits<double>::quiet_NaN();  ///< Where found.
  double rotation_error_rad = std::numeric_limits<double>::quiet_NaN();
  std::string lost_at;  ///< Where missed: the stage (see LossStage); empty = found, or nobody looked.
};

enum class DetectionVerdict : std::uint8_t { kCorrect, kFalsePositive, kGhost, kIgnored };
[[nodiscard]] std::string_view to_string(DetectionVerdict verdict);

struct EvaluatedDetection {
  std::string object;
  Rigid3 camera_from_object;
  double score = 0;
  DetectionVerdict verdict = DetectionVerdict::kFalsePositive;
};

struct EvaluatedView {
  std::string name;
  std::vector<EvaluatedTruth> truth;
  std::vector<EvaluatedDetection> detections;
  RecognitionScore score;
  RecognitionScore strict_score;
  HypothesisCounts counts;
  ChangePointScores points;
  StageTimes times;
};

/// One configuration on one sequence: the unit of work of an evaluation, which is stored and merged as a whole.
struct EvaluatedRun {
  std::string sequence;
  std::string preset;
  int num_previous_views = 0;  ///< K.
  bool is_clustered = true;
  std::string fingerprint;    ///< Of version, settings and models: results of another one are stale.
  int num_threads = 1;        ///< That the times were taken with.
  int num_former_places = 0;  ///< Places that known objects left: the changes that ghosts are counted per.
  bool has_changes = false;   ///< Whether the truth tells the changes, and this preset looks for them.
  EventScore events;          ///< If has_changes.
  std::vector<EvaluatedView> views;

  [[nodiscard]] int num_ghosts() const;
};

/// As JSON, and back: the same run, to the bit.
[[nodiscard]] std::string format_run(const EvaluatedRun& run);
[[nodiscard]] Result<EvaluatedRun> parse_run(std::string_view text, const std::string& name);

}  // namespace resight
