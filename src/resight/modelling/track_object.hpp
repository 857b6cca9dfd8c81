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
  double min_correlation = 0.2;  ///< Of brightness with them, where there is print: less, and it is lost.
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
  /// All of the recording, in order. frame.world_from_camera is object_from_camera; the object frame has z up from the
  /// support, and its origin there, below the middle of what was seen of the object first.
  std::vector<TrainingView> views;
  bool is_camera_still = false;            ///< The background does not move: a turntable.
  std::vector<std::pair<int, int>> loops;  ///< Pairs of views between which the way around the object closes.
  /// How far the object is off where the way closes, at its surface, metres: as it was followed from view to view, and
  /// after all poses were adjusted. NaN = it does not close.
  double drift_m = std::numeric_limits<double>::quiet_NaN();
  double closure_error_m = std::numeric_limits<double>::quiet_NaN();
};

/// Called for each view that was followed, in order.
using TrackObjectProgress = std::function<void(int done, const std::string& view)>;

/// Follows the object (not the background) through a recording of a turntable before a still camera, or of a camera
/// that is carried around the object: only points of the object count. Each view is aligned to those before it, from
/// where features, the last motion, or no motion put it; then the way around is closed, all poses are adjusted together
/// (adjust_pose_graph()) and aligned to the fused whole. Poses of the frames do not count.
///
/// The error says where it failed: no object in the first view, or "lost at view 00037: 11 matches".
[[nodiscard]] Result<ObjectTrack> track_object(std::vector<RgbdFrame> frames, const TrackObjectOptions& options = {},
                                               const TrackObjectProgress& progress = {});

/// Joins a second recording, of the object lying otherwise, to a first: features of both and alignment to the fused
/// first. Its views are added, in the object frame of the first; all are then aligned to the fused whole. The error
/// tells how well the best way to put them together stood.
[[nodiscard]] Result<ObjectTrack> join_tracks(ObjectTrack first, ObjectTrack second,
                                              const TrackObjectOptions& options = {});

}  // namespace resight
