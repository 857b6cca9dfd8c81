// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "resight/io/follow_sequence.hpp"

namespace resight::app {

struct OpenCameraOptions {
  std::string uri;         ///< Of the device, or the path of a recording (`.oni`). Empty: any device.
  std::string intrinsics;  ///< "fx,fy,cx,cy" or a file. Empty: from the field of view that the device tells.
  const DepthSensor* sensor = nullptr;  ///< Whose noise the depth has. Null: structured light.
};

/// A camera of OpenNI2 (Kinect v1, Xtion, PrimeSense and others). It does not move: poses are the identity. The newest
/// frame is taken; those that came before it, while nobody asked, are counted. A recording is played at its own speed,
/// once.
class OpenniCamera {
 public:
  /// Throws an InputError if the program was built without OpenNI2, or if the camera cannot be opened.
  explicit OpenniCamera(const OpenCameraOptions& options);
  ~OpenniCamera();
  OpenniCamera(const OpenniCamera&) = delete;
  OpenniCamera& operator=(const OpenniCamera&) = delete;

  /// The next pair of colour and depth; none after `timeout_s` without one. Throws an InputError if the camera is
  /// gone.
  [[nodiscard]] std::optional<FollowedView> take(double timeout_s);
  [[nodiscard]] bool has_ended() const;   ///< A recording has been played to its last frame.
  [[nodiscard]] int num_skipped() const;  ///< Frames of the camera that nobody took.
  [[nodiscard]] std::vector<std::string> notes() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace resight::app
