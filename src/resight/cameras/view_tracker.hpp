// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <memory>
#include <string>
#include <vector>

#include "resight/cameras/match_views.hpp"
#include "resight/cameras/plausibility.hpp"
#include "resight/cameras/pose_graph.hpp"
#include "resight/features/sift.hpp"
#include "resight/registration/twist.hpp"
#include "resight/registration/view_alignment.hpp"

namespace resight {

/// A view this far from the last keyframe becomes one.
struct KeyframeOptions {
  double shift_m = 0.15;
  double rotation_rad = 0.2;  ///< Or rotated by this.
};

/// A view that follows its predecessor closely is aligned to it without features.
struct FollowOptions {
  double max_step_m = 0.02;  ///< Largest step of a camera that is followed.
  double max_step_rad = 0.03;
  double min_overlap = 0.5;       ///< Least overlap of a view that is followed.
  double min_correlation = 0.65;  ///< Least brightness correlation, where there is texture.
};

/// Places that look alike, such as the two ends of a table, have some features in common. Where only few agree, the
/// brightness must agree, too.
struct FewMatchesOptions {
  int max_matches = 11;
  double min_correlation = 0.65;  ///< Of brightness.
};

struct TrackViewsOptions {
  KeyframeOptions keyframe;
  FollowOptions follow;
  PlausibilityOptions plausible{.min_overlap = 0.2, .max_seen_through = 0.15, .min_correlation = 0.3};
  int num_targets = 3;            ///< Keyframes that a view is aligned to.
  double max_edge_error_sq = 60;  ///< Edges that fit worse after the adjustment are dropped.
  /// Pairs of keyframes that are matched by features to close loops: first those that would join components, then
  /// those of near viewpoints.
  int max_feature_pairs = 3000;
  SiftOptions sift{.root_sift = true};
  MatchViewsOptions match;
  FewMatchesOptions few_matches;
  AlignmentViewOptions view;
  AlignViewOptions align;
  PoseGraphOptions graph;
  double given_sigma_m = 0.02;     ///< Of given positions (add_posed_view()).
  double given_sigma_rad = 0.035;  ///< Of given rotations.
  int num_threads = 1;             ///< Same bits for any value >= 1.
  void check() const;
};

/// Estimated pose of one view.
struct TrackedView {
  std::string name;
  /// In the frame of its component: that of the component's first view, or the given world frame.
  Rigid3 world_from_camera;
  /// Connected component; views of different components could not be joined. After finish(), 0 has the most views.
  int component = 0;
  bool is_keyframe = false;
  /// Feature matches that agree with the keyframe it was joined to; -1 = none were needed.
  int num_matches = -1;
  double overlap = 0;  ///< With the views it was aligned to when it was added.
  /// Standard deviations relative to the keyframe it was joined to: rad about x, y, z, then m.
  Twist sigma = Twist::Zero();
};

/// Result of one add_view().
struct TrackerStep {
  TrackedView view;
  std::vector<PoseEdge> edges;  ///< From earlier views to this one.
};

/// Poses of all views of a sequence, by connected component.
struct CameraTrack {
  std::vector<TrackedView> views;
  std::vector<PoseEdge> edges;  ///< Edges between views that fit the final poses.
  /// Number of connected components.
  int num_components = 0;
  /// Edges across at least num_targets keyframes: loops, or views far apart in the sequence that overlap.
  int num_long_edges = 0;
};

/// Estimates camera poses from the views alone. Dense alignment tracks each view from its predecessor; if that fails,
/// features find it among the keyframes. At the end, overlapping keyframes are connected and all poses adjusted jointly
/// (pose graph). Robust weights suppress changes in the scene. With `mask`, only the masked object counts, and the
/// poses are those of the camera relative to this object.
class ViewTracker {
 public:
  explicit ViewTracker(const TrackViewsOptions& options = {});
  ~ViewTracker();
  ViewTracker(ViewTracker&&) noexcept;

  /// Adds a view and returns its preliminary pose. A view that cannot be joined starts its own component; finish() may
  /// still join it. `mask`: of the view's size, non-zero = use.
  TrackedView add_view(const PreparedView& view, const Image<std::uint8_t>* mask = nullptr);
  /// Result of the last add_view(). Throws std::invalid_argument if no view was added.
  [[nodiscard]] TrackerStep last_step() const;
  /// Restores the next view from the result of an earlier run without a mask. `view` is required for keyframes only;
  /// otherwise it may be null. Throws std::invalid_argument for a keyframe without its view.
  void restore_view(const TrackerStep& step, const PreparedView* view);
  /// Adds a view whose pose is known approximately; finish() refines it. All given views form one component, whose
  /// frame is the world of these poses, whatever joins it.
  void add_posed_view(const PreparedView& view);
  /// Closes loops and adjusts all poses. Further views may be added afterwards.
  [[nodiscard]] CameraTrack finish();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace resight
