// SPDX-License-Identifier: Apache-2.0
#include "resight/io/internal/adjusted_sequence.hpp"

#include <fmt/format.h>

#include <utility>

namespace resight::io {
namespace {

class AdjustedSequence final : public Sequence {
 public:
  AdjustedSequence(std::unique_ptr<Sequence> original, std::function<void(RgbdFrame&)> adjust, std::string note)
      : original_(std::move(original)), adjust_(std::move(adjust)), note_(std::move(note)) {}
  [[nodiscard]] std::string format() const override { return original_->format(); }
  [[nodiscard]] int num_views() const override { return original_->num_views(); }
  [[nodiscard]] std::string view_name(int view) const override { return original_->view_name(view); }
  [[nodiscard]] int scene_id() const override { return original_->scene_id(); }
  [[nodiscard]] int image_id(int view) const override { return original_->image_id(view); }
  [[nodiscard]] Result<RgbdFrame> read_view(int view) const override {
    Result<RgbdFrame> frame = original_->read_view(view);
    if (frame.ok()) adjust_(*frame);
    return frame;
  }
  [[nodiscard]] Result<Rigid3> read_pose(int view) const override { return original_->read_pose(view); }
  [[nodiscard]] bool has_poses() const override { return original_->has_poses(); }
  [[nodiscard]] std::vector<std::string> notes() const override {
    std::vector<std::string> notes = original_->notes();
    notes.push_back(note_);
    return notes;
  }
  [[nodiscard]] bool has_ground_truth() const override { return original_->has_ground_truth(); }
  [[nodiscard]] Result<std::vector<GroundTruthObject>> read_ground_truth(int view) const override {
    return original_->read_ground_truth(view);
  }

 private:
  std::unique_ptr<Sequence> original_;
  std::function<void(RgbdFrame&)> adjust_;
  std::string note_;
};

}  // namespace

std::unique_ptr<Sequence> with_adjusted_frames(std::unique_ptr<Sequence> sequence,
                                               std::function<void(RgbdFrame&)> adjust, std::string note) {
  return std::make_unique<AdjustedSequence>(std::move(sequence), std::move(adjust), std::move(note));
}

std::unique_ptr<Sequence> with_sensor(std::unique_ptr<Sequence> sequence, const DepthSensor& sensor,
                                      const std::string& reason) {
  return with_adjusted_frames(
      std::move(sequence), [noise = sensor.noise](RgbdFrame& frame) { frame.camera.noise = noise; },
      fmt::format("depth noise of {} ({})", sensor.name, reason));
}

}  // namespace resight::io
