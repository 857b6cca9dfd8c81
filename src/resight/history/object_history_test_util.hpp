// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <gtest/gtest.h>

#include <memory>
#include <utility>
#include <vector>

#include "resight/history/object_history.hpp"
#include "resight/models/testing/square_world.hpp"

namespace resight::test {

/// Two kinds of plates, and a history that is given, view by view, what is recognised and seen.
class ObjectHistoryTest : public ::testing::Test {
 protected:
  ObjectHistoryTest() {
    library_.objects = {make_plate("a"), make_plate("b")};
    history_ = std::make_unique<ObjectHistory>(library_);
  }

  // One view: what is recognised, and what the camera sees.
  std::vector<ObjectEvent> view(const std::vector<std::pair<int, Rigid3>>& detected, const RgbdFrame& frame,
                                bool use_evidence = true) {
    std::vector<ObjectObservation> observed;
    for (const auto& [object, pose] : detected) observed.push_back({object, pose, score_});
    return observe(observed, frame, use_evidence);
  }
  std::vector<ObjectEvent> observe(const std::vector<ObjectObservation>& observed, const RgbdFrame& frame,
                                   bool use_evidence = true) {
    HistoryUpdate update = history_->update(view_++, observed, frame, use_evidence, find_change_);
    tracks_ = update.tracks;
    return update.events;
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
  std::vector<int> tracks_;  // Per observation of the last view.
  FindPlaceChange find_change_;
  double score_ = 0.9;
  int view_ = 0;
  const Rigid3 left_ = plate_at(-0.3, 0, 1);
  const Rigid3 right_ = plate_at(0.3, 0, 1);
};

}  // namespace resight::test
