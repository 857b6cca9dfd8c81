// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <gtest/gtest.h>

#include <memory>
#include <utility>
#include <vector>

#include "resight/recognition/object_history.hpp"
#include "resight/recognition/square_world_test_util.hpp"

namespace resight::test {

/// Two kinds of plates, and a history that is told view by view what is recognised and seen.
class ObjectHistoryTest : public ::testing::Test {
 protected:
  ObjectHistoryTest() {
    library_.objects = {make_plate("a"), make_plate("b")};
    history_ = std::make_unique<ObjectHistory>(library_);
  }

  // One view: what the recogniser reports, and what the camera sees.
  std::vector<ObjectEvent> view(const std::vector<std::pair<int, Rigid3>>& detected, const RgbdFrame& frame,
                                bool use_evidence = true) {
    detections_.clear();
    for (const auto& [object, pose] : detected) {
      Detection detection;
      detection.object = object;
      detection.world_from_object = pose;
      detection.score = score_;
      detections_.push_back(detection);
    }
    return history_->update(view_++, detections_, frame, use_evidence);
  }
  static void hide_left_half(RgbdFrame& frame) { hide_columns(frame, 0, frame.depth_m.width() / 2); }
  static void hide_right_half(RgbdFrame& frame) {
    hide_columns(frame, frame.depth_m.width() / 2, frame.depth_m.width());
  }
  static std::vector<ObjectEventKind> kinds(const std::vector<ObjectEvent>& events) {
    std::vector<ObjectEventKind> result;
    for (const ObjectEvent& e : events) result.push_back(e.kind);
    return result;
  }

  ModelLibrary library_;
  std::unique_ptr<ObjectHistory> history_;
  std::vector<Detection> detections_;
  double score_ = 0.9;
  int view_ = 0;
  const Rigid3 left_ = plate_at(-0.3, 0, 1);
  const Rigid3 right_ = plate_at(0.3, 0, 1);
};

}  // namespace resight::test
