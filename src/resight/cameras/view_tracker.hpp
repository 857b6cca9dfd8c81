// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <memory>
#include <string>
#include <vector>

#include "resight/cameras/match_views.hpp"
#include "resight/cameras/pose_graph.hpp"
#include "resight/features/sift.hpp"
#include "resight/registration/view_alignment.hpp"

namespace resight {

struct TrackViewsOptions {
  double keyframe_shift_m = 0.15;     ///< A view so far from the last keyframe...
  double keyframe_turn_rad = 0.2;     ///< ...or so much turned is a keyframe.
  int num_targets = 3;                ///< Keyframes that a view is aligned to.
  double max_step_m = 0.02;           ///< A camera that moves by less from view to view...
  double max_step_rad = 0.03;         ///< ...is followed without features.
  double min_overlap = 0.2;           ///< Two views are joined by no less.
  double min_followed_overlap = 0.5;  ///< The same without features.
  double max_seen_through = 0.15;     ///< More of a view in front of what the other sees: a wrong pose.
  double min_correlation = 0.3;       ///< Of brightness, where there is print.
  double max_edge_error_sq = 60;      ///< Edges that fit worse after the adjustment are dropped.
  int max_feature_pairs = 3000;       ///< Pairs of keyframes that are matched by features to close loops.
  SiftOptions sift{.root_sift = true};
  MatchViewsOptions match;
  AlignmentViewOptions view;
  AlignViewOptions align;
  PoseGraphOptions graph;
  double given_sigma_m = 0.02;     ///< Of given positions (add_posed_view()).
  double given_sigma_rad = 0.035;  ///< Of given rotations.
  int num_threads = 1;             ///< Same bits for any value >= 1.
  void check() const;
};

struct TrackedView {
  std::string name;
  Rigid3 world_from_camera;  ///< In the frame of its part: that of the part's first view, or the given one.
  int part = 0;              ///< Views of different parts could not be joined. 0 = the part with the most views.
  bool is_keyframe = false;
  int num_matches = -1;         ///< Features that agreed with the keyframe it was joined to; -1 = none were needed.
  double overlap = 0;           ///< With the views that it was aligned to, when it came.
  Twist sigma = Twist::Zero();  ///< Standard deviations against the keyframe it was joined to: rad about x, y, z; m.
};

/// What add_view() brought.
struct TrackerStep {
  TrackedView view;
  std::vector<PoseEdge> edges;  ///< From earlier views to this one.
};

struct CameraTrack {
  std::vector<TrackedView> views;
  std::vector<PoseEdge> edges;  ///< Between views; those that were used.
  int num_parts = 0;
  int num_loops = 0;  ///< Edges that are no steps from a view to one just before.
};

/// Camera poses from the views alone. Each view is followed from the one before by dense alignment, or found by its
/// features among the keyframes; at the end keyframes that see the same are joined and all poses adjusted together.
/// Changes in the scene do not pull. With `mask`, only what it holds counts: the poses are then those of the camera
/// relative to that thing.
class ViewTracker {
 public:
  explicit ViewTracker(const TrackViewsOptions& options = {});
  ~ViewTracker();
  ViewTracker(ViewTracker&&) noexcept;

  /// The pose as far as it is known now. A view that cannot be joined to any begins a part of its own; finish() may
  /// still join it. `mask`: of the view's size, non-zero = use.
  TrackedView add_view(const PreparedView& view, const Image<std::uint8_t>* mask = nullptr);
  /// What the last add_view() brought.
  [[nodiscard]] TrackerStep last_step() const;
  /// The next view as an earlier run found it, without a mask. `view`: needed for keyframes only, else it may be null.
  void restore_view(const TrackerStep& step, const PreparedView* view);
  /// A view of which the pose is known, but not well: finish() refines it. It is a keyframe, in one part with the
  /// others that are given.
  void add_posed_view(const PreparedView& view);
  /// Closes loops and adjusts all poses. The tracker may then go on with further views.
  [[nodiscard]] CameraTrack finish();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace resight
