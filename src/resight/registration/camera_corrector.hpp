// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <deque>

#include "resight/registration/view_alignment.hpp"

namespace resight {

struct CorrectCameraOptions {
  bool enabled = false;
  int num_views = 3;           ///< Views before that a view is aligned to.
  double sigma_m = 0.01;       ///< Of given positions.
  double sigma_rad = 0.0175;   ///< Of given rotations (1 deg).
  double min_overlap = 0.2;    ///< Less of the view in common with those before fixes no pose.
  double min_surprise = 22.5;  ///< Squared distance of the given pose from the aligned one, in units of its
                               ///< covariance: below, the given one stands. 22.5: one in 1,000 by chance.
  double max_sigmas = 4;       ///< A given pose is not off by more: then it is not the pose that is wrong.
  AlignmentViewOptions view;
  AlignViewOptions align;  ///< Its prior is that of sigma_m and sigma_rad.
  void check() const;
};

/// Corrects given camera poses view by view. Each view is aligned to the preceding views at their corrected poses.
/// Robust weights keep changed regions from pulling. A pose that agrees with its alignment is returned unchanged, bit
/// for bit.
class CameraCorrector {
 public:
  explicit CameraCorrector(const CorrectCameraOptions& options = {});

  /// Returns the corrected world_from_camera of a view (with normals) and keeps the view as a target for the next ones.
  Rigid3 add_view(const PreparedView& view);

 private:
  struct View {
    AlignmentView view;
    Rigid3 world_from_camera;
  };
  [[nodiscard]] Rigid3 correct(const AlignmentView& view, const Rigid3& world_from_camera) const;
  [[nodiscard]] bool is_surprising(const AlignedView& aligned, const Rigid3& world_from_camera) const;

  CorrectCameraOptions options_;
  std::deque<View> views_;
};

}  // namespace resight
