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
#include "resight/registration/pose_uncertainty.hpp"

namespace resight {

/// What one of the views in use says about a detection.
struct DetectionViewEvidence {
  int view = 0;                ///< Number of the view in the sequence.
  bool allowed = true;         ///< False: the change detection excludes it (the object was not there yet, or had left).
  double visible_share = 0;    ///< Of the model's points.
  double explained_share = 0;  ///< Of the visible ones.
  double color_share = 0;      ///< Of the model's points: shown in the right colours, without depth. Newest view only,
                               ///< and only if depth confirms less than min_reported_share.
  /// Of the model's points: what the view itself sees and explains.
  [[nodiscard]] double confirmed_share() const { return visible_share * explained_share + color_share; }
};

/// An object recognised in the scene as it stands at a view.
struct Detection {
  int object = -1;  ///< Index into the ModelLibrary.
  int track = -1;   ///< Number in the object history; the same object keeps it when it moves.
  std::uint64_t hypothesis_id = 0;
  Rigid3 world_from_object;
  PoseUncertainty uncertainty;
  double score = 0;          ///< How likely it is right, in [0, 1] (detection_score.hpp).
  double fit = 0;            ///< How well its visible points are explained, in [0, 1].
  double visible_share = 0;  ///< Of the model's points, over all views in use.
  std::vector<DetectionViewEvidence> views;
  /// What the object history needs of it.
  [[nodiscard]] ObjectObservation observation() const {
    return {object, world_from_object, score, views.empty() ? 1 : views.back().confirmed_share()};
  }
};

/// Numbers of hypotheses on their way through a view.
struct HypothesisCounts {
  int correspondences = 0;
  int generated = 0;
  int merged = 0;  ///< With those of the last K views.
  int clustered = 0;
  int accepted = 0;
};

/// All that one view brought.
struct SceneUpdate {
  int view = 0;  ///< Number in the sequence, from 0.
  std::string view_name;
  Rigid3 world_from_camera;  ///< As given, or corrected (RecognizerConfig::poses).
  std::vector<Detection> detections;
  std::vector<ObjectEvent> events;
  ChangeResult changes;  ///< Empty under preset mvr.
  bool searched = true;  ///< False: nothing new was to be seen, and only what is known was looked at (ViewNovelty).
  std::vector<std::string> left_out;  ///< What there was no time for (RecognizerConfig::deadline_ms), for the reader.
  HypothesisCounts counts;
  std::size_t reconstruction_points = 0;
  StageTimes times;
};

}  // namespace resight
