// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "resight/changes/change_regions.hpp"
#include "resight/recognition/recognizer_config.hpp"
#include "resight/reconstruction/dynamic_scene.hpp"
#include "resight/registration/camera_errors.hpp"

namespace resight::bench {

/// Change detection view by view, with corrected camera as in SceneRecognizer.
class ChangeRun {
 public:
  /// Changes are detected whatever the preset. The errors of the camera are those of `sequence`. Throws
  /// std::invalid_argument for a config that fails check().
  ChangeRun(const RecognizerConfig& config, const Sequence& sequence);

  /// Changes of this view against the reconstruction from the views before it.
  ChangeResult add_view(RgbdFrame frame);
  /// The view that was added last, at its corrected pose.
  [[nodiscard]] const RgbdFrame& frame() const { return scene_.window().back().raw; }
  /// Regions of the changes of the view that was added last.
  [[nodiscard]] std::vector<ChangeRegion> find_regions(const ChangeResult& changes) const {
    return find_change_regions(frame(), changes, voxel_m_);
  }
  [[nodiscard]] int num_corrected() const { return num_corrected_; }

 private:
  PrepareViewOptions prepare_;
  CameraErrors camera_errors_;
  double voxel_m_;
  DynamicScene scene_;
  int num_corrected_ = 0;
};

}  // namespace resight::bench
