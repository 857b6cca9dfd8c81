// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>

#include "resight/history/object_history_test_util.hpp"

namespace resight {
namespace {

using test::hide_columns;
using test::ObjectHistoryTest;
using test::plate_at;
using test::see_nothing;
using test::see_plates;
using K = ObjectEventKind;

TEST_F(ObjectHistoryTest, TracksObjectsUntilTheyAreSeenToLeave) {
  EXPECT_TRUE(history_->tracked_objects().empty());
  view({{0, left_}, {1, right_}}, see_plates({left_, right_}));
  ASSERT_EQ(history_->tracked_objects().size(), 2U);
  view({{1, right_}}, see_nothing());  // No depth: nothing is known of the left one.
  const std::vector<TrackedObject> known = history_->tracked_objects();
  ASSERT_EQ(known.size(), 2U);
  EXPECT_EQ(known[0].object, 0);
  EXPECT_EQ(known[0].last_view, 0);
  EXPECT_EQ(known[0].world_from_object.translation, left_.translation);
  EXPECT_EQ(known[1].last_view, 1);
  view({{1, right_}}, see_plates({right_}));  // The left place is seen free.
  ASSERT_EQ(history_->tracked_objects().size(), 1U);
  EXPECT_EQ(history_->tracked_objects()[0].object, 1);
}

TEST_F(ObjectHistoryTest, FoundThenStillThere) {
  EXPECT_EQ(kinds(view({{0, left_}}, see_plates({left_}))), (std::vector{K::kFound}));
  EXPECT_EQ(kinds(view({{0, left_}}, see_plates({left_}))), (std::vector{K::kStillThere}));
  EXPECT_EQ(tracks_[0], 0);
}

TEST_F(ObjectHistoryTest, MissedButPresentIsNotSeenAndNeverRemoved) {
  view({{0, left_}}, see_plates({left_}));
  EXPECT_EQ(kinds(view({}, see_plates({left_}))), (std::vector{K::kNotSeen}));
  EXPECT_EQ(kinds(view({}, see_nothing())), (std::vector{K::kNotSeen}));
  EXPECT_TRUE(history_->finish().empty());
  EXPECT_EQ(kinds(view({{0, left_}}, see_plates({left_}))), (std::vector{K::kStillThere}));
}

// A card of 10 mm: its support lies within the margin of depth. Change detection sees that it left, or came.
TEST_F(ObjectHistoryTest, ChangeDetectionTellsOfFlatObjects) {
  const RgbdFrame support = see_plates({plate_at(-0.3, 0, 1.01)});
  const RgbdFrame card = see_plates({left_});
  for (const PlaceChange change : {PlaceChange::kNone, PlaceChange::kLeft, PlaceChange::kCame}) {
    history_ = std::make_unique<ObjectHistory>(library_);
    find_change_ = [&](int object, const Rigid3& world_from_object, int) {
      EXPECT_EQ(object, 0);
      EXPECT_EQ(world_from_object.translation, left_.translation);
      return change;
    };
    view({}, support);
    const bool came = change == PlaceChange::kCame;
    EXPECT_EQ(kinds(view({{0, left_}}, card)), (std::vector{came ? K::kAdded : K::kFound}));
    const bool left = change == PlaceChange::kLeft;
    EXPECT_EQ(kinds(view({}, card)), (std::vector{K::kNotSeen})) << "the depth says that it is there";
    EXPECT_EQ(kinds(view({}, support)), left ? std::vector<K>{} : std::vector{K::kNotSeen});
    EXPECT_EQ(kinds(view({}, support)), (std::vector{left ? K::kRemoved : K::kNotSeen}));
  }
}

TEST_F(ObjectHistoryTest, MovedIsOneEventWithBothPlaces) {
  view({{0, left_}}, see_plates({left_}));
  const auto events = view({{0, right_}}, see_plates({right_}));
  ASSERT_EQ(kinds(events), (std::vector{K::kMoved}));
  EXPECT_DOUBLE_EQ(events[0].world_from_object_before->translation.x(), -0.3);
  EXPECT_DOUBLE_EQ(events[0].world_from_object_after->translation.x(), 0.3);
  EXPECT_EQ(tracks_[0], 0);
  EXPECT_TRUE(history_->finish().empty());
}

TEST_F(ObjectHistoryTest, AMoveRecognisedOneViewLateIsStillAMove) {
  view({{0, left_}}, see_plates({left_}));
  EXPECT_TRUE(view({}, see_plates({right_})).empty());
  EXPECT_EQ(kinds(view({{0, right_}}, see_plates({right_}))), (std::vector{K::kMoved}));
}

TEST_F(ObjectHistoryTest, AMoveSupersedesItsReportedRemoval) {
  view({{0, left_}}, see_plates({left_}));
  RgbdFrame left_is_free = see_plates({});
  hide_right_half(left_is_free);  // Where it is now no view sees.
  view({}, left_is_free);
  const auto removal = view({}, left_is_free);
  ASSERT_EQ(kinds(removal), (std::vector{K::kRemoved}));
  const auto events = view({{0, right_}}, see_plates({right_}));
  ASSERT_EQ(kinds(events), (std::vector{K::kMoved}));
  EXPECT_DOUBLE_EQ(events[0].world_from_object_before->translation.x(), -0.3);
  ASSERT_TRUE(events[0].supersedes);
  EXPECT_EQ(events[0].supersedes->kind, K::kRemoved);
  EXPECT_EQ(events[0].supersedes->track, removal[0].track);
  EXPECT_EQ(events[0].supersedes->view, removal[0].view);
}

TEST_F(ObjectHistoryTest, AnObjectAwayInBetweenWasRemovedAndAdded) {
  view({{0, left_}}, see_plates({left_}));
  EXPECT_TRUE(view({}, see_plates({})).empty());  // Free are both places.
  const auto events = view({{0, right_}}, see_plates({right_}));
  ASSERT_EQ(kinds(events), (std::vector{K::kRemoved, K::kAdded}));
  EXPECT_EQ(events[0].view, 1);
  EXPECT_EQ(events[1].view, 2);
  EXPECT_TRUE(history_->finish().empty());
}

TEST_F(ObjectHistoryTest, AnObjectThatLeavesAfterOneWasAddedElsewhereHasMovedThere) {
  view({{0, left_}}, see_plates({left_}));
  // Something else stands at the old place: it is neither free nor out of sight.
  ASSERT_EQ(kinds(view({{0, right_}}, see_plates({left_, right_}))), (std::vector{K::kNotSeen, K::kAdded}));
  const int added = tracks_[0];
  const auto events = view({{0, right_}}, see_plates({right_}));
  ASSERT_EQ(kinds(events), (std::vector{K::kMoved}));
  EXPECT_EQ(events[0].track, 0);
  EXPECT_DOUBLE_EQ(events[0].world_from_object_before->translation.x(), -0.3);
  EXPECT_DOUBLE_EQ(events[0].world_from_object_after->translation.x(), 0.3);
  ASSERT_TRUE(events[0].supersedes);
  EXPECT_EQ(events[0].supersedes->kind, K::kAdded);
  EXPECT_EQ(events[0].supersedes->track, added);
  EXPECT_EQ(events[0].supersedes->view, 1);
  EXPECT_EQ(tracks_[0], 0) << "the older track goes on";
  EXPECT_EQ(history_->tracked_objects().size(), 1U);
  EXPECT_EQ(kinds(view({{0, right_}}, see_plates({right_}))), (std::vector{K::kStillThere}));
  EXPECT_TRUE(history_->finish().empty());
}

TEST_F(ObjectHistoryTest, AnObjectThatMovesOnWhenItsOldPlaceIsSeenHasMovedTwice) {
  const Rigid3 third = plate_at(0, 0.25, 1);
  view({{0, left_}}, see_plates({left_}));
  view({{0, right_}}, see_plates({left_, right_}));
  const auto events = view({{0, third}}, see_plates({third}));
  ASSERT_EQ(kinds(events), (std::vector{K::kMoved, K::kMoved}));
  EXPECT_DOUBLE_EQ(events[0].world_from_object_after->translation.x(), 0.3);
  EXPECT_DOUBLE_EQ(events[1].world_from_object_before->translation.x(), 0.3);
  EXPECT_DOUBLE_EQ(events[1].world_from_object_after->translation.x(), 0.0);
}

TEST_F(ObjectHistoryTest, AnObjectAtItsPlaceIsNotTheNewOne) {
  view({{0, left_}}, see_plates({left_}));
  RgbdFrame left_is_hidden = see_plates({right_});
  hide_left_half(left_is_hidden);
  EXPECT_EQ(kinds(view({{0, left_}, {0, right_}}, left_is_hidden)), (std::vector{K::kStillThere, K::kAdded}));
  EXPECT_NE(tracks_[0], tracks_[1]);
}

TEST_F(ObjectHistoryTest, AShiftThatTheViewDoesNotConfirmIsNoMove) {
  ObjectHistoryOptions options;
  options.min_new_share = 0.02;
  history_ = std::make_unique<ObjectHistory>(library_, options);
  view({{0, left_}}, see_plates({left_}));
  // A third of the old place is free, the rest is unchanged.
  const Rigid3 shifted = plate_at(-0.24, 0, 1);
  EXPECT_EQ(kinds(observe({{0, shifted, score_, 0.005}}, see_plates({shifted}))), (std::vector{K::kStillThere}));
  EXPECT_TRUE(history_->finish().empty());
}

TEST_F(ObjectHistoryTest, OneObservationBelongsToOneTrackOnly) {
  // Two on top of each other, as far as plates go; the one detection left lies within half a diameter of both.
  const Rigid3 upper = plate_at(-0.3, -0.04, 1);
  const Rigid3 lower = plate_at(-0.3, 0.04, 1);
  view({{0, upper}, {0, lower}}, see_plates({upper, lower}));
  const Rigid3 shifted = plate_at(-0.24, 0, 1);
  view({{0, shifted}}, see_plates({shifted}));
  const std::vector<TrackedObject> known = history_->tracked_objects();
  EXPECT_EQ(std::ranges::count(known, shifted.translation.x(),
                               [](const TrackedObject& k) { return k.world_from_object.translation.x(); }),
            1);
  EXPECT_EQ(known.size(), 2U) << "the other was not seen to leave";
}

TEST_F(ObjectHistoryTest, AnObjectRemovedBeforeTheMemoryBeginsHasNotMoved) {
  ObjectHistoryOptions options;
  options.memory.max_views = 2;
  history_ = std::make_unique<ObjectHistory>(library_, options);
  view({{0, left_}}, see_plates({left_}));
  RgbdFrame left_is_free = see_plates({});
  hide_right_half(left_is_free);
  for (int i = 0; i < 2; ++i) view({}, left_is_free);
  for (int i = 0; i < 2; ++i) view({}, see_nothing());
  EXPECT_EQ(kinds(view({{0, right_}}, see_plates({right_}))), (std::vector{K::kFound}));
}

TEST_F(ObjectHistoryTest, AnObjectSeenAfterTheOtherWasAddedIsAnother) {
  view({{0, left_}}, see_plates({left_}));
  view({{0, left_}, {0, right_}}, see_plates({left_, right_}));
  view({{0, right_}}, see_plates({right_}));
  EXPECT_EQ(kinds(view({{0, right_}}, see_plates({right_}))), (std::vector{K::kStillThere, K::kRemoved}));
}

TEST_F(ObjectHistoryTest, RemovedIsReportedOnceWithTheViewThatSawIt) {
  view({{0, left_}, {1, right_}}, see_plates({left_, right_}));
  view({{1, right_}}, see_plates({right_}));
  const auto events = view({{1, right_}}, see_plates({right_}));
  const auto removed = std::find_if(events.begin(), events.end(), [](const auto& e) { return e.kind == K::kRemoved; });
  ASSERT_NE(removed, events.end());
  EXPECT_EQ(removed->view, 1);
  EXPECT_EQ(removed->object, 0);
  EXPECT_EQ(kinds(view({{1, right_}}, see_plates({right_}))), (std::vector{K::kStillThere}));
}

TEST_F(ObjectHistoryTest, RemovedInTheLastViewComesWithFinish) {
  view({{0, left_}}, see_plates({left_}));
  EXPECT_TRUE(view({}, see_plates({})).empty());
  EXPECT_EQ(kinds(history_->finish()), (std::vector{K::kRemoved}));
  EXPECT_TRUE(history_->finish().empty());
}

TEST_F(ObjectHistoryTest, AddedNeedsAnEarlierViewOfFreeSpace) {
  view({{0, left_}}, see_plates({left_}));
  EXPECT_EQ(kinds(view({{0, left_}, {1, right_}}, see_plates({left_, right_}))),
            (std::vector{K::kStillThere, K::kAdded}));
}

TEST_F(ObjectHistoryTest, FirstSeenAtAnUnobservedPlaceIsOnlyFound) {
  view({{0, left_}}, see_nothing());
  EXPECT_EQ(kinds(view({{0, left_}, {1, right_}}, see_plates({left_, right_}))),
            (std::vector{K::kStillThere, K::kFound}));
}

TEST_F(ObjectHistoryTest, PutBackAfterRemovalIsAddedUnderItsTrack) {
  view({{0, left_}}, see_plates({left_}));
  view({}, see_plates({}));
  view({}, see_plates({}));
  EXPECT_EQ(kinds(view({{0, left_}}, see_plates({left_}))), (std::vector{K::kAdded}));
  EXPECT_EQ(tracks_[0], 0);
}

TEST_F(ObjectHistoryTest, ASmallShiftIsAMoveAndNotASecondObject) {
  const Rigid3 shifted = plate_at(-0.24, 0, 1);
  view({{0, left_}}, see_plates({left_}));
  EXPECT_EQ(kinds(view({{0, shifted}}, see_plates({shifted}))), (std::vector{K::kMoved}));
  EXPECT_EQ(kinds(view({{0, shifted}}, see_plates({shifted}))), (std::vector{K::kStillThere}));
}

TEST_F(ObjectHistoryTest, APoseCorrectedWhereNothingIsSeenFreeIsNoMove) {
  // Turned by 30 deg about the line of sight: the plate still lies where it was taken to be.
  const Rigid3 turned = left_ * Rigid3::from_axis_angle(Eigen::Vector3d::UnitZ(), 0.52);
  view({{0, left_}}, see_plates({left_}));
  EXPECT_EQ(kinds(view({{0, turned}}, see_plates({left_}))), (std::vector{K::kStillThere}));
  EXPECT_EQ(tracks_[0], 0);
  ASSERT_EQ(history_->tracked_objects().size(), 1U);
  EXPECT_EQ(history_->tracked_objects()[0].world_from_object.rotation, turned.rotation);
  // Nothing is known without change detection: what is reported elsewhere has moved.
  EXPECT_EQ(kinds(view({{0, left_}}, see_plates({left_}), false)), (std::vector{K::kMoved}));
}

TEST_F(ObjectHistoryTest, ANewObjectWhoseOldPlaceIsOutOfSightHasMoved) {
  view({{0, left_}}, see_plates({left_}));
  RgbdFrame only_right = see_plates({right_});
  hide_left_half(only_right);
  const auto events = view({{0, right_}}, only_right);
  ASSERT_EQ(kinds(events), (std::vector{K::kMoved}));
  EXPECT_EQ(tracks_[0], 0);
  EXPECT_LE(events[0].confidence, 0.5);
  EXPECT_TRUE(view({{0, right_}}, see_plates({right_})).front().kind == K::kStillThere);
  EXPECT_TRUE(history_->finish().empty());  // Its old place is known to be left: no removal follows.
}

TEST_F(ObjectHistoryTest, AnObjectThatOnlyEarlierViewsConfirmIsNotReported) {
  ObjectHistoryOptions options;
  options.min_new_share = 0.02;
  history_ = std::make_unique<ObjectHistory>(library_, options);
  const auto events = observe({{0, left_, 0, 0.005}, {1, right_, 0, 0.03}}, see_plates({right_}));
  ASSERT_EQ(kinds(events), (std::vector{K::kFound}));
  EXPECT_EQ(events[0].object, 1);
  EXPECT_EQ(tracks_[0], -1);
}

TEST_F(ObjectHistoryTest, OfTwoOfAKindTheOneOutOfSightHasMoved) {
  const Rigid3 third = plate_at(0, 0.2, 1);
  view({{0, left_}, {0, right_}}, see_plates({left_, right_}));
  RgbdFrame without_left = see_plates({right_, third});
  hide_columns(without_left, 0, without_left.depth_m.width() / 3);
  const auto events = view({{0, right_}, {0, third}}, without_left);
  ASSERT_EQ(kinds(events), (std::vector{K::kStillThere, K::kMoved}));
  EXPECT_DOUBLE_EQ(events[1].world_from_object_before->translation.x(), -0.3);
  EXPECT_LE(events[1].confidence, 0.5);
}

TEST_F(ObjectHistoryTest, OfTwoOutOfSightNoneIsTheNewOne) {
  const Rigid3 third = plate_at(0, 0.2, 1);
  view({{0, left_}, {0, right_}}, see_plates({left_, right_}));
  RgbdFrame without_both = see_plates({third});
  hide_columns(without_both, 0, without_both.depth_m.width() / 3);
  hide_columns(without_both, 2 * without_both.depth_m.width() / 3, without_both.depth_m.width());
  const auto seen = kinds(view({{0, third}}, without_both));
  EXPECT_EQ(std::count(seen.begin(), seen.end(), K::kAdded), 1);
  EXPECT_EQ(std::count(seen.begin(), seen.end(), K::kMoved), 0);
}

// The detection at the old place lives on older views; the new one stands before a part of it.
TEST_F(ObjectHistoryTest, AnOldPlaceThatTheViewDoesNotConfirmIsLeft) {
  ObjectHistoryOptions options;
  options.min_new_share = 0.02;
  history_ = std::make_unique<ObjectHistory>(library_, options);
  ASSERT_EQ(kinds(observe({{0, left_, 0.9, 0.5}}, see_plates({left_}))), (std::vector{K::kFound}));
  const RgbdFrame half_free = see_plates({right_, plate_at(-0.36, 0, 1)});  // Half of the old place is free.
  const auto events = observe({{0, left_, 0.9, 0.005}, {0, right_, 0.9, 0.5}}, half_free);
  ASSERT_EQ(kinds(events), (std::vector{K::kMoved}));
  EXPECT_DOUBLE_EQ(events[0].world_from_object_before->translation.x(), -0.3);
  EXPECT_EQ(tracks_[0], -1) << "one object, one place";
  EXPECT_EQ(tracks_[1], 0);
}

TEST_F(ObjectHistoryTest, TwoOfAKindKeepTheirTracks) {
  view({{0, left_}, {0, right_}}, see_plates({left_, right_}));
  EXPECT_EQ(kinds(view({{0, right_}, {0, left_}}, see_plates({left_, right_}))),
            (std::vector{K::kStillThere, K::kStillThere}));
  EXPECT_NE(tracks_[0], tracks_[1]);
  EXPECT_EQ(tracks_[1], 0);
}

TEST_F(ObjectHistoryTest, AStaticWorldHasNoRemoval) {
  view({{0, left_}}, see_plates({left_}), false);
  EXPECT_EQ(kinds(view({}, see_plates({}), false)), (std::vector{K::kNotSeen}));
  EXPECT_TRUE(history_->finish().empty());
}

}  // namespace
}  // namespace resight
