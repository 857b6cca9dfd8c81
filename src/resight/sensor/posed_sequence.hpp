// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <utility>
#include <vector>

#include "resight/core/check.hpp"
#include "resight/sensor/sequence.hpp"

namespace resight {

/// Views of another sequence with other camera poses. The other sequence must outlive this object.
class PosedSequence : public Sequence {
 public:
  /// `views`: numbers of the views in `original`, in order. `world_from_camera`: one pose per view.
  PosedSequence(const Sequence& original, std::vector<int> views, std::vector<Rigid3> world_from_camera)
      : original_(original), views_(std::move(views)), world_from_camera_(std::move(world_from_camera)) {
    require(views_.size() == world_from_camera_.size(), "world_from_camera: must contain one pose per view");
  }
  [[nodiscard]] std::string format() const override { return original_.format(); }
  [[nodiscard]] int num_views() const override { return static_cast<int>(views_.size()); }
  [[nodiscard]] std::string view_name(int view) const override { return original_.view_name(at(view)); }
  [[nodiscard]] int scene_id() const override { return original_.scene_id(); }
  [[nodiscard]] int image_id(int view) const override { return original_.image_id(at(view)); }
  [[nodiscard]] Result<RgbdFrame> read_view(int view) const override {
    Result<RgbdFrame> frame = original_.read_view(at(view));
    if (frame.ok()) frame->world_from_camera = world_from_camera_[static_cast<std::size_t>(view)];
    return frame;
  }
  [[nodiscard]] Result<Rigid3> read_pose(int view) const override {
    return world_from_camera_.at(static_cast<std::size_t>(view));
  }
  [[nodiscard]] std::vector<std::string> notes() const override { return original_.notes(); }
  [[nodiscard]] bool has_ground_truth() const override { return original_.has_ground_truth(); }
  [[nodiscard]] Result<std::vector<GroundTruthObject>> read_ground_truth(int view) const override {
    return original_.read_ground_truth(at(view));
  }

 private:
  [[nodiscard]] int at(int view) const { return views_.at(static_cast<std::size_t>(view)); }

  const Sequence& original_;
  std::vector<int> views_;
  std::vector<Rigid3> world_from_camera_;
};

}  // namespace resight
