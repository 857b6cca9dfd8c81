// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <vector>

#include "resight/inspection/finding.hpp"
#include "resight/sensor/rgbd_frame.hpp"
#include "resight/sensor/sequence.hpp"

namespace resight {

/// Gross faults of poses that the depths of two views show: other conventions and other units are tried on few pixels.
/// Views come one by one, and are compared with the first.
class PoseCheck {
 public:
  /// Whether a view with this pose says something new: the camera has moved so far that readings of the poses differ.
  /// Four nearer views are compared, too: they are as far or farther away if the poses are in metres where millimetres
  /// are expected. Each is twice as far as the one before, because the depths of near views agree in any case, and
  /// views far apart do not overlap.
  [[nodiscard]] bool wants(const Rigid3& world_from_camera) const;
  /// The faults that this view shows. The first view shows none.
  [[nodiscard]] std::vector<Finding> add(const RgbdFrame& frame, int view);
  /// A fault was found, or a view after which others say nothing new.
  [[nodiscard]] bool is_done() const { return is_done_; }

 private:
  [[nodiscard]] double move_m(const Rigid3& pose) const;
  [[nodiscard]] bool has_moved(const Rigid3& pose) const;
  [[nodiscard]] bool may_have_moved(const Rigid3& pose) const;

  std::optional<RgbdFrame> first_;  // Until is_done_.
  double depth_m_ = 0;              // Median of the first view.
  double next_move_m_ = 0;          // Of a view that is compared, if the poses are in metres.
  int num_near_views_ = 0;
  bool is_done_ = false;
};

/// Faults that the first view, one in the middle or the last one shows, each fault once, and gross faults of poses
/// (PoseCheck). Takes some hundredths of a second. Views that cannot be read are left to others. `uses_poses`: whether
/// the given poses matter.
[[nodiscard]] std::vector<Finding> check_quickly(const Sequence& sequence, bool uses_poses);

}  // namespace resight
