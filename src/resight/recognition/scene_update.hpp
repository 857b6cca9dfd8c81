// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "resight/changes/change_detector.hpp"
#include "resight/core/timing.hpp"
#include "resight/geometry/rigid3.hpp"
#include "resight/history/object_event.hpp"
#include "resight/history/object_observation.hpp"
#include "resight/registration/camera_corrector.hpp"
#include "resight/registration/camera_errors.hpp"
#include "resight/registration/pose_uncertainty.hpp"

namespace resight {

/// Evidence of one view of the window for a detection.
struct DetectionViewEvidence {
  int view = 0;                ///< Number of the view in the sequence.
  bool allowed = true;         ///< False: change detection excludes it (the object was not there yet, or had left).
  double visible_share = 0;    ///< Of the model's points.
  double explained_share = 0;  ///< Of the visible points.
  double color_share = 0;      ///< Of the model's points: confirmed by their colours, without depth. Newest view only,
                               ///< and only if depth confirms less than min_reported_share.
  /// Share of the model's points that the view itself confirms.
  [[nodiscard]] double confirmed_share() const { return visible_share * explained_share + color_share; }
};

/// An object recognised in the scene at a view.
struct Detection {
  int object = -1;  ///< Index into the ModelLibrary.
  int track = -1;   ///< Number in the object history; the same object keeps it when it moves.
  std::uint64_t hypothesis_id = 0;
  Rigid3 world_from_object;
  PoseUncertainty uncertainty;
  double score = 0;  ///< Probability that it is right, in [0, 1]: HypothesisScoreOptions, apply_instance_prior().
  double fit = 0;    ///< How well its visible points are explained, in [0, 1].
  double visible_share = 0;  ///< Of the model's points, over all views in use.
  std::vector<DetectionViewEvidence> views;
  /// What the object history needs of it.
  [[nodiscard]] ObjectObservation observation() const {
    return {object, world_from_object, score, views.empty() ? 1 : views.back().confirmed_share()};
  }
};

/// Number of hypotheses after each stage.
struct HypothesisCounts {
  int correspondences = 0;
  int generated = 0;
  int merged = 0;  ///< With those of the last K views.
  int clustered = 0;
  int accepted = 0;
};

/// Result of one view.
struct SceneUpdate {
  int view = 0;  ///< Number in the sequence, from 0.
  std::string view_name;
  Rigid3 world_from_camera;  ///< As given, or corrected (RecognizerConfig::camera).
  PoseCorrection pose_correction;
  CameraErrors camera_errors;  ///< That were corrected; see SceneRecognizer::set_camera_errors().
  std::vector<Detection> detections;
  std::vector<ObjectEvent> events;
  ChangeResult changes;  ///< Empty under preset mvr.
  bool searched = true;  ///< False: the view shows nothing new; only tracked objects were verified (SearchPlanner).
  std::vector<std::string> left_out;  ///< Skipped to meet run.deadline_ms; for display.
  HypothesisCounts counts;
  std::size_t reconstruction_points = 0;
  StageTimes times;
};

}  // namespace resight
