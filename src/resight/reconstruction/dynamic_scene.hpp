// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <deque>

#include "resight/changes/change_detector.hpp"
#include "resight/reconstruction/integration.hpp"
#include "resight/sensor/prepared_view.hpp"

namespace resight {

struct DynamicSceneOptions {
  int num_previous_views = 5;       ///< K: the reconstruction is made of the current view and up to K before it.
  bool detect_changes = true;       ///< Off: a static world, nothing is ever cleared.
  double clear_tolerance_m = 0.02;  ///< Points this near to removed ones are cleared from older views (V4R: 2 cm).
  PrepareViewOptions prepare;       ///< As the views were prepared: cleared ones are prepared again.
  DetectChangesOptions changes;
  IntegrateOptions integrate;
  void check() const;
};

/// Algorithm 1 (paper Sec. III-B), view by view: the reconstruction of a scene that changes, from its last K + 1 views.
class DynamicScene {
 public:
  /// A view of the window.
  struct View {
    int number = 0;               ///< Counts the views added, from 0.
    RgbdFrame raw;                ///< As it was taken: for looking back.
    PreparedView cleared;         ///< Without what later views saw removed.
    PointCloud removed_in_world;  ///< What this view saw removed, and what it brought; world frame.
    PointCloud novel_in_world;
    ViewVoxels voxels;  ///< Of `cleared`: only a view that a removal reaches is reduced again.
  };

  /// Throws std::invalid_argument for options that fail check().
  explicit DynamicScene(DynamicSceneOptions options = {});

  /// Takes over the next view (same world frame): finds its changes against the reconstruction so far, clears what it
  /// saw removed from all views before it - and from none after, so that an object put back at its old place survives
  /// -, forgets the views that fall out of the window and reconstructs. Without change detection, or for the first
  /// view, the changes are empty.
  ChangeResult add_view(PreparedView view);

  /// Oldest first, the current view last.
  [[nodiscard]] const std::deque<View>& window() const { return window_; }
  /// Psi_k, world frame.
  [[nodiscard]] const PointCloud& reconstruction() const { return reconstruction_.cloud_in_world; }

 private:
  [[nodiscard]] ChangeResult find_changes(const PreparedView& view) const;
  void clear_from_window(const PointCloud& removed_in_world);
  void reconstruct();

  DynamicSceneOptions options_;
  std::deque<View> window_;
  VoxelNumbers numbers_;                 // Of the voxels of the window, and of some before.
  std::size_t num_blocks_at_start_ = 0;  // When the window alone was numbered.
  VoxelMerger merger_;
  Reconstruction reconstruction_;
  int num_views_ = 0;
};

}  // namespace resight
