// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>

#include "resight/history/object_history_test_util.hpp"

namespace resight {
namespace {

using test::ObjectHistoryTest;
using test::plate_at;
using test::see_nothing;
using test::see_plates;
using K = ObjectEventKind;

class TentativeTrackHistoryTest : public ObjectHistoryTest {
 protected:
  TentativeTrackHistoryTest() {
    options_.confirm_score = 0.7;
    history_ = std::make_unique<ObjectHistory>(library_, options_);
  }
  std::vector<ObjectEvent> tentative_view(const std::vector<std::pair<int, Rigid3>>& detected, const RgbdFrame& frame) {
    score_ = 0.5;
    std::vector<ObjectEvent> events = view(detected, frame);
    score_ = 0.9;
    return events;
  }
  ObjectHistoryOptions options_;
};

TEST_F(TentativeTrackHistoryTest, NoEventIsReportedBeforeAViewConfirmsIt) {
  view({}, see_plates({}));
  EXPECT_TRUE(tentative_view({{0, left_}}, see_plates({left_})).empty());
  const int track = tracks_[0];
  EXPECT_GE(track, 0);
  ASSERT_EQ(history_->tracked_objects().size(), 1U) << "it is looked for in the next view";
  EXPECT_TRUE(tentative_view({{0, left_}}, see_plates({left_})).empty());
  EXPECT_EQ(tracks_[0], track);
  const auto events = view({{0, left_}}, see_plates({left_}));
  ASSERT_EQ(kinds(events), (std::vector{K::kAdded}));
  EXPECT_EQ(events[0].track, track);
  EXPECT_EQ(events[0].view, 3);
  EXPECT_EQ(history_->tracked_objects().size(), 1U);
  EXPECT_EQ(kinds(tentative_view({{0, left_}}, see_plates({left_}))), (std::vector{K::kStillThere}))
      << "once is enough";
}

TEST_F(TentativeTrackHistoryTest, ATrackNeverConfirmedEndsWithoutAnEvent) {
  tentative_view({{0, left_}}, see_plates({left_}));
  EXPECT_TRUE(view({}, see_nothing()).empty());
  EXPECT_EQ(history_->tracked_objects().size(), 1U) << "the view does not see its place";
  EXPECT_TRUE(view({}, see_plates({})).empty());
  EXPECT_TRUE(history_->tracked_objects().empty());
  EXPECT_TRUE(view({}, see_plates({})).empty());
  EXPECT_TRUE(history_->finish().empty());
}

TEST_F(TentativeTrackHistoryTest, ATrackOutOfSightIsForgottenWithTheMemory) {
  options_.memory.max_views = 3;
  history_ = std::make_unique<ObjectHistory>(library_, options_);
  tentative_view({{0, left_}}, see_plates({left_}));
  for (int i = 0; i < 3; ++i) view({}, see_nothing());
  EXPECT_EQ(history_->tracked_objects().size(), 1U);
  view({}, see_nothing());
  EXPECT_TRUE(history_->tracked_objects().empty());
}

TEST_F(TentativeTrackHistoryTest, AMoveWaitsForConfirmationAtTheNewPlace) {
  view({{0, left_}}, see_plates({left_}));
  EXPECT_TRUE(tentative_view({{0, right_}}, see_plates({right_})).empty());
  EXPECT_EQ(kinds(tentative_view({{0, right_}}, see_plates({right_}))), (std::vector{K::kRemoved}));
  const auto events = view({{0, right_}}, see_plates({right_}));
  ASSERT_EQ(kinds(events), (std::vector{K::kMoved}));
  ASSERT_TRUE(events[0].supersedes);
  EXPECT_EQ(events[0].supersedes->kind, K::kRemoved);
  EXPECT_EQ(tracks_[0], 0);
  EXPECT_EQ(history_->tracked_objects().size(), 1U);
}

TEST_F(TentativeTrackHistoryTest, ATrackSeenHereWhileTheOtherWasElsewhereIsNotThatOne) {
  for (const bool is_out_of_sight : {false, true}) {
    history_ = std::make_unique<ObjectHistory>(library_, options_);
    view_ = 0;
    view({}, see_plates({}));
    view({{0, left_}}, see_plates({left_}));
    score_ = 0.5;
    auto both = view({{0, right_}, {0, left_}}, see_plates({left_, right_}));  // The left one is known.
    EXPECT_EQ(kinds(both), (std::vector{K::kStillThere}));
    score_ = 0.9;
    RgbdFrame frame = see_plates({right_});
    if (is_out_of_sight) hide_left_half(frame);
    const auto events = view({{0, right_}}, frame);
    EXPECT_EQ(std::ranges::count(kinds(events), K::kMoved), 0) << is_out_of_sight;
    EXPECT_EQ(std::ranges::count(kinds(events), K::kAdded), 1) << is_out_of_sight;
  }
}

TEST_F(TentativeTrackHistoryTest, AnObjectWithinItsOldPlaceHasMovedWhateverItsScore) {
  const Rigid3 shifted = plate_at(-0.24, 0, 1);
  view({{0, left_}}, see_plates({left_}));
  EXPECT_EQ(kinds(tentative_view({{0, shifted}}, see_plates({shifted}))), (std::vector{K::kMoved}));
}

TEST_F(TentativeTrackHistoryTest, ATentativeObjectReplacesNoOther) {
  view({{1, left_}}, see_plates({left_}));
  for (int i = 0; i < 3; ++i) EXPECT_EQ(kinds(tentative_view({{0, left_}}, see_nothing())), (std::vector{K::kNotSeen}));
  EXPECT_EQ(history_->tracked_objects().size(), 2U);
}

TEST_F(TentativeTrackHistoryTest, ATrackFoundToBeAnotherEnds) {
  const Rigid3 beside = plate_at(-0.25, 0, 1);
  view({{0, left_}}, see_plates({left_}));
  tentative_view({{0, left_}, {0, beside}}, see_plates({left_}));
  EXPECT_EQ(history_->tracked_objects().size(), 2U);
  view({{0, left_}}, see_plates({left_}));
  EXPECT_EQ(history_->tracked_objects().size(), 1U);
}

TEST_F(TentativeTrackHistoryTest, WithoutChangeDetectionItIsForgottenInTime) {
  options_.memory.max_views = 3;
  history_ = std::make_unique<ObjectHistory>(library_, options_);
  score_ = 0.5;
  EXPECT_TRUE(view({{0, left_}}, see_plates({left_}), false).empty());
  for (int i = 0; i < 3; ++i) view({}, see_plates({}), false);
  EXPECT_EQ(history_->tracked_objects().size(), 1U);
  view({}, see_plates({}), false);
  EXPECT_TRUE(history_->tracked_objects().empty());
}

TEST_F(TentativeTrackHistoryTest, AnObjectThatHardlyOverlapsIsAnother) {
  tentative_view({{0, left_}}, see_plates({left_}));
  const int track = tracks_[0];
  tentative_view({{0, plate_at(-0.25, 0, 1)}}, see_nothing());
  EXPECT_EQ(tracks_[0], track);
  tentative_view({{0, plate_at(-0.12, 0, 1)}}, see_nothing());  // Its centre is nearer than half a diameter.
  EXPECT_NE(tracks_[0], track);
  EXPECT_EQ(history_->tracked_objects().size(), 2U);
}

TEST_F(TentativeTrackHistoryTest, TwoOfAViewAreTwo) {
  const Rigid3 beside = plate_at(-0.28, 0, 1);
  tentative_view({{0, left_}, {0, beside}}, see_plates({left_}));
  EXPECT_NE(tracks_[0], tracks_[1]);
  EXPECT_EQ(history_->tracked_objects().size(), 2U);
}

}  // namespace
}  // namespace resight
