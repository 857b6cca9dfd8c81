// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <functional>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "resight/cameras/match_views.hpp"
#include "resight/cameras/plausibility.hpp"
#include "resight/cameras/pose_graph.hpp"
#include "resight/core/result.hpp"
#include "resight/features/sift.hpp"
#include "resight/modelling/fusion.hpp"
#include "resight/modelling/object_region.hpp"
#include "resight/registration/view_alignment.hpp"

namespace resight {

/// Features of the views of an object, and their matches.
struct TrackFeaturesOptions {
  SiftOptions sift{.root_sift = true};
  MatchViewsOptions match{.pose = {.inlier_distance_m = 0.005, .max_normal_angle_rad = 0.8, .min_inliers = 6}};
  double sigma_m = 0.003;    ///< Standard deviation of a position from matches, for the alignment that follows.
  double sigma_rad = 0.006;  ///< The same of its rotation.
};

/// Given poses, of a view relative to its predecessor.
struct GivenPoseOptions {
  double sigma_m = 0.01;    ///< Standard deviation of a position.
  double sigma_rad = 0.02;  ///< The same of the rotation.
  int min_matches = 12;     ///< As many matches that contradict a given pose refute it.
};

/// How a second recording is joined to the first.
struct JoinOptions {
  int num_views = 10;         ///< Views of the second recording that are aligned to the model of the first.
  double min_overlap = 0.06;  ///< Least mean overlap of these views with the model.
};

/// All values are ours.
struct TrackObjectOptions {
  ObjectRegionOptions region;
  SegmentObjectOptions segment;
  TrackFeaturesOptions features;
  GivenPoseOptions given;
  AlignmentViewOptions view{.num_levels = 2, .min_edge_distance_px = 2, .mean_radius = 0.0125};
  AlignViewOptions align{.max_distance_m = 0.02, .min_distance_m = 0.006, .brightness_sigma = 25};
  PoseGraphOptions graph;
  int num_targets = 3;  ///< Predecessors that a view is aligned to.
  /// Of a view with its predecessors. If its pose is not plausible, the object is lost.
  PlausibilityOptions plausible{.min_overlap = 0.4, .max_seen_through = 0.25, .min_correlation = 0.2};
  double max_edge_angle_rad = 0.6;  ///< Largest angle between the directions of two views that an edge joins.
  double min_still_share = 0.8;     ///< Least share of unchanged pixels beside the object if the camera stands still.
  int num_refinements = 2;          ///< Rounds of: fuse all views, align each to the whole.
  JoinOptions join;
  /// Of the model that views are aligned to. It has the colours of the most usual light.
  FuseViewsOptions fuse{.voxel_m = 0.002, .truncation_m = 0.006, .color_from = 0, .color_to = 1};
  int num_threads = 1;  ///< Same bits for any value >= 1.
  void check() const;
};

/// A recording with poses and masks.
struct ObjectTrack {
  /// All views of the recording, in order. frame.world_from_camera is object_from_camera. The object frame has z up
  /// from the support and its origin on the support, below the middle of the object as first observed.
  std::vector<TrainingView> views;
  bool is_camera_still = false;  ///< The background does not move: a turntable.
  /// Pairs of views between which the track around the object closes.
  std::vector<std::pair<int, int>> loops;
  /// Median error at the surface where the track closes (m), after view-to-view tracking. NaN = it does not close.
  double drift_m = std::numeric_limits<double>::quiet_NaN();
  /// Same error after all poses were adjusted. NaN = it does not close.
  double closure_error_m = std::numeric_limits<double>::quiet_NaN();
};

/// Called for each tracked view, in order.
using TrackObjectProgress = std::function<void(int done, const std::string& view)>;

/// Tracks the object, not the background, through a recording. Either the object turns on a turntable in front of a
/// static camera, or the camera moves around the object. Only object points count. Each view is aligned to its
/// predecessors, starting from feature matches and from the given poses of the frames, if these differ; otherwise, or
/// if the given poses do not fit, from constant motion and from no motion. Then loops are closed, all poses are
/// adjusted jointly (adjust_pose_graph()) and aligned to the fused model.
///
/// Errors name the place of the failure: no object in the first view, or "lost at view 00037: 11 matches".
[[nodiscard]] Result<ObjectTrack> track_object(std::vector<RgbdFrame> frames, const TrackObjectOptions& options = {},
                                               const TrackObjectProgress& progress = {});

/// Joins a second recording, with the object in another orientation, to the first: by features of both and alignment to
/// the fused first recording, or by shape. The views of the second are appended in the object frame of the first; then
/// all views are aligned to the fused model. The error describes the best attempt.
[[nodiscard]] Result<ObjectTrack> join_tracks(ObjectTrack first, ObjectTrack second,
                                              const TrackObjectOptions& options = {});

}  // namespace resight
