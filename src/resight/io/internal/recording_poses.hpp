// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "resight/io/internal/recording_scan.hpp"
#include "resight/recordings/transform_buffer.hpp"

namespace resight::io {

/// What a recording says about where its cameras were, and about the unit of depth.
class RecordedPoses {
 public:
  /// From all transforms, odometry and poses.
  [[nodiscard]] static Result<RecordedPoses> make(const Recording& recording, const RecordingScan& scan,
                                                  const ViewTopics& topics, const RecordingTopics& given);
  [[nodiscard]] bool has_poses() const { return !world_frame_.empty(); }
  /// At the time of an image, interpolated.
  [[nodiscard]] std::optional<Rigid3> world_from_camera(std::int64_t stamp_ns) const;
  /// Of the two cameras; none if nothing is known.
  [[nodiscard]] std::optional<Rigid3> color_from_depth(const ViewTopics& topics) const;
  /// Metres per unit; none if the recording does not say it.
  [[nodiscard]] std::optional<double> depth_unit_m() const { return depth_unit_m_; }
  /// One line for the user.
  [[nodiscard]] std::string describe() const;

 private:
  void add_odometry(const std::vector<ScannedTransform>& odometry);
  [[nodiscard]] Result<void> choose_frames(const RecordingTopics& given);
  [[nodiscard]] Result<void> read_librealsense(const Recording& recording, const ViewTopics& topics);

  TransformBuffer transforms_;
  std::string world_frame_;  ///< Empty: no poses.
  std::string camera_frame_;
  std::string pose_topic_;   ///< Of geometry_msgs/PoseStamped, if its poses are used,
  std::string posed_frame_;  ///< as those of this frame: the topmost one above the camera.
  std::optional<Rigid3> color_from_depth_;
  std::optional<double> depth_unit_m_;
};

}  // namespace resight::io
