// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <functional>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "resight/cameras/match_views.hpp"
#include "resight/cameras/pose_graph.hpp"
#include "resight/core/result.hpp"
#include "resight/features/sift.hpp"
#include "resight/modelling/fusion.hpp"
#include "resight/modelling/object_region.hpp"
#include "resight/registration/view_alignment.hpp"

namespace resight {

/// All values are ours.
struct TrackObjectOptions {
  ObjectRegionOptions region;
  SegmentObjectOptions segment;
  SiftOptions sift{.root_sift = true};
  MatchViewsOptions match{.pose = {.inlier_distance_m = 0.005, .max_normal_angle_rad = 0.8, .min_inliers = 6}};
  AlignmentViewOptions view{.num_levels = 2, .min_edge_distance_px = 2, .mean_radius = 0.0125};
  AlignViewOptions align{.max_distance_m = 0.02, .min_distance_m = 0.006, .brightness_sigma = 25};
  PoseGraphOptions graph;
  double match_sigma_m = 0.003;    ///< Of a pose that features gave, for the alignment that follows.
  double match_sigma_rad = 0.006;  ///< The same of its rotation.
  int num_targets = 3;             ///< Views before that a view is aligned to.
  double min_overlap = 0.4;        ///< Of a view with those before: less, and the object is lost.
  double max_seen_through =
      0.25;                      ///< Of a view's points, in front of what the views before show: more, and it is lost.
  double min_correlation = 0.2;  ///< Of brightness with them, where there is texture: less, and it is lost.
  double max_edge_angle_rad = 0.6;  ///< Between the directions of two views that are joined by an edge.
  double min_still_share = 0.8;    ///< Of the pixels beside the object that do not change when the camera stands still.
  int num_refinements = 2;         ///< Rounds of: fuse all views, align each to the whole.
  int num_join_views = 10;         ///< Of a second recording that are tried on the model of the first.
  double min_join_overlap = 0.06;  ///< Of those with that model, in the mean: less, and they cannot be joined.
  /// Of the model that views are aligned to: its colours must be those of the light as it mostly fell.
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
/// static camera, or the camera moves around the object. Only object points count, and the given poses of the frames
/// are ignored. Each view is aligned to its predecessors, starting from feature matches, constant motion or no motion.
/// Then loops are closed, all poses are adjusted jointly (adjust_pose_graph()) and aligned to the fused model.
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
