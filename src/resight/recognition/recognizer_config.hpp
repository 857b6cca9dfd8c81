// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "resight/changes/change_detector.hpp"
#include "resight/changes/removal_support.hpp"
#include "resight/core/options.hpp"
#include "resight/features/shot.hpp"
#include "resight/features/sift.hpp"
#include "resight/history/object_history.hpp"
#include "resight/hypotheses/clustering.hpp"
#include "resight/hypotheses/generation.hpp"
#include "resight/recognition/search_planner_options.hpp"
#include "resight/reconstruction/view_voxels.hpp"
#include "resight/registration/camera_corrector.hpp"
#include "resight/registration/depth_bias.hpp"
#include "resight/sensor/color_offset.hpp"
#include "resight/sensor/prepared_view.hpp"
#include "resight/shape_search/shape_search.hpp"
#include "resight/verification/verify_options.hpp"

namespace resight {

/// Seed and time budget of a run.
struct RunOptions {
  std::uint64_t seed = 1;
  std::optional<double> deadline_ms{};
};

inline void declare(OptionVisitor& v, RunOptions& o) {
  v.field("seed", o.seed, "Seed of all random choices of all stages.");
  v.field("deadline_ms", o.deadline_ms, positive(),
          "Time limit per view, from its arrival on. Work that cannot be done in time is left out, and the results "
          "depend on the machine. off: no limit.");
}

/// Errors of the camera that its views show: of its poses, between its colours and its depth, and of its depth.
struct CameraOptions {
  CorrectCameraOptions poses{};
  ColorOffsetOptions color_offset{};
  DepthBiasOptions depth_bias{};
};

inline void declare(OptionVisitor& v, CameraOptions& o) {
  v.group("poses", o.poses);
  v.group("color_offset", o.color_offset);
  v.group("depth_bias", o.depth_bias);
}

/// Features of a view, and their matches in the models.
struct FeatureOptions {
  SiftOptions sift{};
  ShotOptions shot{};
  MatchFeaturesOptions match{};
};

inline void declare(OptionVisitor& v, FeatureOptions& o) {
  v.group("sift", o.sift);
  v.group("shot", o.shot);
  v.group("match", o.match);
}

/// Hypotheses of a view and of the views before it.
struct HypothesisOptions {
  GenerateHypothesesOptions generate{};
  std::optional<ClusterHypothesesOptions> cluster = ClusterHypothesesOptions{};
  double min_carried_share = 0;
};

inline void declare(OptionVisitor& v, HypothesisOptions& o) {
  v.merge(o.generate);
  v.group("cluster", o.cluster, "Whether hypotheses of several views are clustered.", "paper, Tables II and III");
  v.field(
      "min_carried_share", o.min_carried_share, between(0, 1),
      "A hypothesis that is visible, and explains a smaller share of itself or differs in texture, is not carried over "
      "to the next views. 0: all are.",
      "ours");
}

/// Detected changes, and what follows from them.
struct ChangeOptions {
  bool enabled = true;
  DetectChangesOptions detection{};
  double clear_tolerance_m = 0.02;
  RemovalSupportOptions removal{};
};

inline void declare(OptionVisitor& v, ChangeOptions& o) {
  v.field("enabled", o.enabled, "Off: the static world of the paper's baseline.", "paper");
  v.only_if(o.enabled, "enabled", "true", [&] {
    v.merge(o.detection);
    v.field("clear_tolerance_m", o.clear_tolerance_m, positive(),
            "Points within this distance of removed ones are cleared from older views.", "V4R");
    v.group("removal", o.removal);
  });
}

/// Which accepted hypotheses are detections.
struct DetectionOptions {
  double min_reported_share = 0;
  double min_score = 0;
  double further_instance_odds = 1;
  bool weigh_competing_poses = false;
};

inline void declare(OptionVisitor& v, DetectionOptions& o) {
  v.field("min_reported_share", o.min_reported_share, between(0, 1),
          "An object of which the view itself confirms a smaller share of the model (hidden, or outside the image) is "
          "tracked, but no detection of this view. 0: every object is one.",
          "ours");
  v.field(
      "min_score", o.min_score, between(0, 1),
      "An object that is less likely right (verify.score) is tracked, but no detection of this view. 0: every object "
      "is one.",
      "ours");
  v.field("further_instance_odds", o.further_instance_odds, between(1e-6, 1),
          "Prior odds of each further instance of an object, as a share of those of the first: look-alikes pass for "
          "further instances. 1: as likely as the first, for scenes with many copies.",
          "fitted");
  v.field(
      "weigh_competing_poses", o.weigh_competing_poses,
      "An object is less likely right if other poses of it explain the place about as well, or another object just as "
      "well.",
      "ours");
}

/// Every setting of the recogniser. Start from a preset, then change single fields. The keys of settings files are the
/// names of these fields, but for camera, hypotheses.generate and changes.detection, whose fields stand in the table
/// itself.
struct RecognizerConfig {
  std::string preset = "default";
  int num_previous_views = 5;
  bool remember_objects = false;
  RunOptions run{};
  CameraOptions camera{};
  PrepareViewOptions prepare{};
  FeatureOptions features{};
  HypothesisOptions hypotheses{};
  ShapeSearchOptions shape{};
  ChangeOptions changes{};
  IntegrateOptions integrate{};
  VerifyOptions verify{};
  DetectionOptions detections{};
  ObjectHistoryOptions history{};
  SearchPlannerOptions search{};

  /// "mvr" (the paper's baseline: a static world), "mvr-chd" (the paper's system) or "default" (the best we know); see
  /// presets.cpp. Throws std::invalid_argument, listing the names, for any other.
  [[nodiscard]] static RecognizerConfig from_preset(const std::string& name);

  /// Of all stages. Same bytes for any value >= 1.
  void set_num_threads(int num_threads);
  /// run.seed, and those of all stages.
  void set_seed(std::uint64_t seed);
  /// Single views stand for themselves.
  [[nodiscard]] bool remembers() const { return remember_objects && num_previous_views > 0; }
  /// Whether tracked objects decide which views, and which places in them, are searched.
  [[nodiscard]] bool limits_search() const {
    return remembers() && (search.max_new_share.has_value() || search.place_interval.has_value());
  }
  void check() const;
  /// Every setting that has an effect as key and value, in order: what summary.json keeps of a run.
  [[nodiscard]] std::vector<std::pair<std::string, std::string>> to_settings() const;
};

inline void declare(OptionVisitor& v, RecognizerConfig& o) {
  v.label(o.preset);
  v.field(
      "num_previous_views", o.num_previous_views, between(0, 1000),
      "K: a view is recognised together with up to K views before it. 0: by itself; remember_objects, poses and search "
      "then have no effect, and changes only on events.",
      "paper");
  v.field("remember_objects", o.remember_objects,
          "Recognised objects remain hypotheses until a view sees their place empty, not only for K views (K > 0).",
          "ours");
  v.group("run", o.run);
  v.merge(o.camera);
  v.group("prepare", o.prepare);
  v.group("features", o.features);
  v.group("hypotheses", o.hypotheses);
  v.group("shape", o.shape);
  v.group("changes", o.changes);
  v.group("integrate", o.integrate);
  v.group("verify", o.verify);
  v.group("detections", o.detections);
  v.group("history", o.history);
  v.group("search", o.search);
  v.rule(o.remember_objects || (!o.search.max_new_share && !o.search.place_interval),
         "search.max_new_share and search.place_interval have no effect unless remember_objects = true: a view that is "
         "not searched needs the objects of others (set both to \"off\")");
  // Pose correction takes points 3 px from an edge (AlignmentViewOptions).
  const double min_cap_px = std::max({3.0, o.integrate.min_edge_distance_px, o.verify.visibility.min_edge_distance_px,
                                      o.shape.enabled ? o.shape.scene.min_edge_distance_px : 0});
  v.rule(o.prepare.edges.max_distance_px >= min_cap_px,
         "prepare.edges.max_distance_px must be at least 3 and every min_edge_distance_px: else no point is far enough "
         "from an edge");
}

}  // namespace resight
