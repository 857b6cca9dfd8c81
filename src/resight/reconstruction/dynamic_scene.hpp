// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <deque>
#include <vector>

#include "resight/changes/change_detector.hpp"
#include "resight/core/timing.hpp"
#include "resight/reconstruction/integration.hpp"
#include "resight/registration/camera_corrector.hpp"
#include "resight/sensor/prepared_view.hpp"

namespace resight {

struct DynamicSceneOptions {
  int num_previous_views = 5;       ///< K: the reconstruction is made of the current view and up to K before it.
  bool detect_changes = true;       ///< Off: a static world, nothing is ever cleared.
  double clear_tolerance_m = 0.02;  ///< Points this near to removed ones are cleared from older views (V4R: 2 cm).
  CorrectCameraOptions poses;       ///< Without views to compare with (K = 0), given poses stay.
  PrepareViewOptions prepare;       ///< As the views were prepared: cleared ones are prepared again.
  DetectChangesOptions changes;
  IntegrateOptions integrate;
  void check() const;
};

/// Algorithm 1 (paper, Sec. III-B), view by view: reconstructs a changing scene from its last K + 1 views.
class DynamicScene {
 public:
  /// A view of the window.
  struct View {
    int number = 0;               ///< Number of the view, counted from 0.
    RgbdFrame raw;                ///< The frame as recorded, at its corrected pose.
    PreparedView cleared;         ///< The view without points that later views observed as removed.
    PointCloud removed_in_world;  ///< Points that this view observed as removed; world frame.
    /// Points that this view observed as novel; world frame.
    PointCloud novel_in_world;
    ViewVoxels voxels;  ///< Voxels of `cleared`. Only views affected by a removal are reduced again.
    PoseCorrection pose_correction = {};
    bool is_suspect = false;  ///< ChangeResult::pose_suspect. Only the last view may be.
  };

  /// Throws std::invalid_argument if the options are invalid.
  explicit DynamicScene(const DynamicSceneOptions& options = {});

  /// Processes the next view (same world frame): corrects its pose, finds its changes against the current
  /// reconstruction, clears the removed points from all earlier views, drops views that leave the window, and
  /// reconstructs. Later views are not cleared, so that an object put back at its former place persists. Without change
  /// detection, or for the first view, the changes are empty. Adds the times of the steps to `times` unless it is null.
  /// Throws std::invalid_argument if the view is not prepared or has no normals.
  ///
  /// A view whose pose is suspect leaves the window when the next view comes. If that view contradicts the others and
  /// agrees with the suspect one, the scene has changed as a whole, or the poses have jumped: the others leave instead.
  /// A camera that stands still is not suspect if its correction confirms that.
  ChangeResult add_view(PreparedView view, StageTimes* times = nullptr);
  /// Forgets all views: their intrinsics do not fit those of the next ones. Numbering goes on.
  void forget_views();

  /// Number of views so far.
  [[nodiscard]] int num_views() const { return num_views_; }
  /// Views of the window, oldest first; the current view is the last.
  [[nodiscard]] const std::deque<View>& window() const { return window_; }
  /// Numbers of these views.
  [[nodiscard]] std::vector<int> view_numbers() const;
  /// Psi_k; world frame.
  [[nodiscard]] const PointCloud& reconstruction() const { return reconstruction_.cloud_in_world; }

 private:
  [[nodiscard]] bool is_known_still(const CorrectedCamera& camera) const;
  ChangeResult add_at_pose(PreparedView view, bool is_still);
  [[nodiscard]] ChangeResult find_changes(const PreparedView& view, bool is_still);
  [[nodiscard]] ChangeResult compare_with(bool is_suspect, const PreparedView& view, bool is_still);
  void clear_from_window(const PointCloud& removed_in_world);
  void reconstruct();

  DynamicSceneOptions options_;
  CameraCorrector corrector_;
  std::deque<View> window_;
  VoxelNumbers numbers_;  // Of the voxels of the window and of some earlier ones.
  // Number of blocks when numbering last restarted, with the voxels of the window alone.
  std::size_t num_blocks_at_start_ = 0;
  VoxelMerger merger_;
  Reconstruction reconstruction_;
  int num_views_ = 0;
};

}  // namespace resight
