// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "resight/evaluation/ghosts.hpp"
#include "resight/evaluation/match_detections.hpp"
#include "resight/report/overlay.hpp"

namespace resight {

/// Comparison of a view with its ground truth.
struct ViewEvaluation {
  MatchDetectionsResult matching;  ///< Within 5 cm and 30 deg by default.
  RecognitionScore strict_score;   ///< Within 1 cm and 10 deg.
  std::vector<Ghost> ghosts;
  std::vector<GroundTruthObject> missed;  ///< False negatives.
};

/// What results and report keep of a view. Instead of clouds and images, it holds one compressed picture, so that long
/// runs need little memory.
struct ViewRecord {
  int scene_id = 0;    ///< BOP scene, or 0.
  int image_id = 0;    ///< BOP image, or the number of the view.
  SceneUpdate update;  ///< Without the clouds and masks of `changes`.
  std::size_t num_novel_points = 0;
  std::size_t num_removed_points = 0;
  std::vector<DetectionMark> marks;          ///< One per detection.
  std::optional<ViewEvaluation> evaluation;  ///< If there is ground truth.
  std::vector<std::uint8_t> picture_jpeg;    ///< Overlay; empty = none.
  std::string picture_file;  ///< Its name beside the pages of the report, if it is a file (store_picture()).
};

/// One recognition run over a sequence: the content of the results files and of one column of the report.
struct ReportRun {
  std::string preset;
  std::string sequence;                                       ///< Name or path, for display.
  std::string version;                                        ///< Version of resight.
  std::vector<std::pair<std::string, std::string>> settings;  ///< From RecognizerConfig::to_settings().
  std::vector<ViewRecord> views;
  std::size_t peak_memory_bytes = 0;  ///< 0 = unknown.
  int num_threads = 0;                ///< 0 = unknown.
  /// Paths of the inputs relative to the folder of the results, for `resight view`. Empty = unknown.
  std::string sequence_path;
  std::string models_path;
  std::vector<std::string> sequence_options;  ///< With which the sequence was opened: name and value in turn.
  std::optional<int> num_skipped_views;       ///< That newer ones overtook, where views were taken as they came.
};

/// Scores one view. `former_places`: see find_former_places(); `update.view` determines which of them apply. Places are
/// compared in the world of the ground truth, which corrected camera poses do not change.
[[nodiscard]] ViewEvaluation evaluate_view(const SceneUpdate& update, const TruthView& truth,
                                           std::span<const FormerPlace> former_places, const Camera& camera,
                                           const ModelLibrary& library, const MatchDetectionsOptions& options = {});

struct MakeViewRecordOptions {
  bool picture = true;
  int picture_quality = 82;
  int max_picture_width_px = 640;  ///< 0 = as wide as the view.
  DrawOverlayOptions overlay = {};
  void check() const;  ///< Throws std::invalid_argument: field, value, rule.
};

/// Condenses one view for results and report: draws its overlay, with the verdicts of `evaluation` if there is one, and
/// drops the clouds.
[[nodiscard]] ViewRecord make_view_record(const RgbdFrame& frame, const ModelLibrary& library, SceneUpdate update,
                                          std::optional<ViewEvaluation> evaluation = std::nullopt,
                                          const MakeViewRecordOptions& options = {});

/// Sums over the views of a run.
struct RunSummary {
  int num_views = 0;
  int num_detections = 0;
  int num_events = 0;        ///< Changes of the scene: added, moved and removed events.
  int num_scored_views = 0;  ///< Views with ground truth, which the scores refer to.
  RecognitionScore score;
  RecognitionScore strict_score;
  int num_ghosts = 0;
  StageTimes times;
  double mean_view_wall_s = 0;    ///< NaN without views.
  double median_view_wall_s = 0;  ///< NaN without views.
};
/// Summarises a run.
[[nodiscard]] RunSummary summarize(const ReportRun& run);

}  // namespace resight
