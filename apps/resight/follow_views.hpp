// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>

#include "commands.hpp"
#include "openni_camera.hpp"
#include "resight/inspection/quick_check.hpp"
#include "resight/io/follow_sequence.hpp"

namespace resight::app {

/// Where views come from while they are recorded.
class LiveViews {
 public:
  virtual ~LiveViews() = default;
  /// Waits for the next view. None at the end: after Ctrl-C, the idle time, or a recording. Throws an InputError if no
  /// view has come until then.
  [[nodiscard]] virtual std::optional<FollowedView> next() = 0;
  /// Views that newer ones have overtaken.
  [[nodiscard]] virtual int num_skipped() const = 0;
};

/// Views of a folder that is being written. Tells on standard error what it waits for and what it assumed.
class FolderViews final : public LiveViews {
 public:
  FolderViews(const std::filesystem::path& folder, const OpenSequenceOptions& open, const FollowArguments& arguments);
  [[nodiscard]] std::optional<FollowedView> next() override;
  [[nodiscard]] int num_skipped() const override { return follower_.num_skipped(); }

 private:
  void tell_waiting();

  SequenceFollower follower_;
  FollowArguments arguments_;
  PoseCheck pose_check_;
  std::string told_;
  bool has_view_ = false;
};

/// Views of a camera that does not move.
class CameraViews final : public LiveViews {
 public:
  /// `name`: "openni2", or "openni2:" and the URI of a device or the path of a recording.
  CameraViews(const std::string& name, const OpenSequenceOptions& open, const FollowArguments& arguments);
  [[nodiscard]] std::optional<FollowedView> next() override;
  [[nodiscard]] int num_skipped() const override { return camera_.num_skipped(); }

 private:
  std::string name_;
  double depth_bias_per_m_;
  OpenniCamera camera_;
  FollowArguments arguments_;
  bool has_view_ = false;
};

}  // namespace resight::app
