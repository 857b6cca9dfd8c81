// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "resight/changes/change_detector.hpp"
#include "resight/changes/removal_support.hpp"
#include "resight/core/result.hpp"
#include "resight/features/shot.hpp"
#include "resight/features/sift.hpp"
#include "resight/history/object_history.hpp"
#include "resight/hypotheses/clustering.hpp"
#include "resight/hypotheses/generation.hpp"
#include "resight/recognition/detection_score.hpp"
#include "resight/recognition/search_planner_options.hpp"
#include "resight/reconstruction/integration.hpp"
#include "resight/registration/camera_corrector.hpp"
#include "resight/sensor/prepared_view.hpp"
#include "resight/shape_search/shape_search.hpp"
#include "resight/verification/verify_options.hpp"

namespace resight {

/// Every setting of the recogniser. Start from a preset, then change single fields.
struct RecognizerConfig {
  std::string preset = "default";
  int num_previous_views =
      5;  ///< K: the current view is recognised together with up to K views before it; 0 = single view.
  bool detect_changes = true;       ///< Off: the static world of the paper's baseline.
  bool cluster_hypotheses = true;   ///< Off: Tables II and III without clustering.
  double clear_tolerance_m = 0.02;  ///< Points this near to removed ones are cleared from older views (V4R: 2 cm).
  bool judge_absent = false;      ///< What the changes say is gone is not dropped, but judged by the newest view alone.
  double min_reported_share = 0;  ///< An object of which the view itself confirms less (of the model's points; hidden,
                                  ///< or outside the image) is known to the history, but no detection of this view.
  double min_carried_share = 0;   ///< A hypothesis that is seen, and explains less of itself or has another print, is
                                  ///< not carried over to the next views; 0 = all are.
  bool remember_objects = false;  ///< What was recognised is a hypothesis as long as it is not seen to leave, not only
                                  ///< for K views (K > 0).
  double deadline_ms = 0;  ///< From the moment that a view is handed over; what cannot be done until then is left out,
                           ///< and the results depend on the machine. 0 = no deadline.
  bool skip_planes = false;     ///< No keypoints on planes larger than the largest object (shape.enabled only).
  SearchPlannerOptions search;  ///< No effect unless objects are remembered: a view that is not searched needs them.
  CorrectCameraOptions poses;   ///< Of given camera poses (K > 0).
  PrepareViewOptions prepare;
  SiftOptions sift;
  ShotOptions shot;
  MatchFeaturesOptions match;
  GenerateHypothesesOptions generate;
  ShapeSearchOptions shape;
  ClusterHypothesesOptions cluster;
  DetectChangesOptions changes;
  RemovalSupportOptions removal;
  IntegrateOptions integrate;
  VerifyOptions verify;
  DetectionScoreOptions score;
  ObjectHistoryOptions history;

  /// "mvr" (the paper's baseline: a static world), "mvr-chd" (the paper's system) or "default" (the best we know).
  /// Throws std::invalid_argument, listing the names, for any other.
  [[nodiscard]] static RecognizerConfig from_preset(const std::string& name);

  /// Same bytes for any value >= 1.
  void set_num_threads(int num_threads);
  void set_seed(std::uint64_t seed);
  /// Single views stand for themselves.
  [[nodiscard]] bool remembers() const { return remember_objects && num_previous_views > 0; }
  /// Whether tracked objects decide where a view is searched (SearchPlannerOptions::place_interval).
  [[nodiscard]] bool skips_places() const { return remembers() && search.place_interval > 1; }
  void check() const;
  /// Every field as "section.name" and its value as text, in order: what summary.json keeps of a run.
  [[nodiscard]] std::vector<std::pair<std::string, std::string>> to_settings() const;
};

/// Overwrites fields of `config` by a TOML file: sections and keys as in to_settings() (e.g. "[changes]\ntolerance_m =
/// 0.01"). Unknown keys, wrong types and values out of range are errors that name file and key.
[[nodiscard]] Result<RecognizerConfig> read_config(const std::filesystem::path& path, RecognizerConfig config);

}  // namespace resight
