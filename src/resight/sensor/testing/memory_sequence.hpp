// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <utility>
#include <vector>

#include "resight/sensor/sequence.hpp"

namespace resight::test {

/// A sequence of frames held in memory. A view without pixels cannot be read.
class MemorySequence : public Sequence {
 public:
  explicit MemorySequence(std::vector<RgbdFrame> frames) : frames_(std::move(frames)) {}
  [[nodiscard]] std::string format() const override { return "memory"; }
  [[nodiscard]] int num_views() const override { return static_cast<int>(frames_.size()); }
  [[nodiscard]] std::string view_name(int view) const override { return at(view).name; }
  [[nodiscard]] Result<RgbdFrame> read_view(int view) const override {
    if (at(view).depth_m.size() == 0) return Error{"view " + std::to_string(view) + " cannot be read"};
    return at(view);
  }

 private:
  [[nodiscard]] const RgbdFrame& at(int view) const { return frames_.at(static_cast<std::size_t>(view)); }
  std::vector<RgbdFrame> frames_;
};

}  // namespace resight::test
