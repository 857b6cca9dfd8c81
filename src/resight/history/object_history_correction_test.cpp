// SPDX-License-Identifier: Apache-2.0
// ObjectHistory: objects in the place of another one, and events that a later view corrects.
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

TEST_F(ObjectHistoryTest, AnotherObjectInItsPlaceShowsThatItHasLeft) {
  view({{0, left_}}, see_plates({left_}));
  // The depth is the same: nothing is seen through.
  const auto events = view({{1, left_}}, see_plates({left_}));
  ASSERT_EQ(kinds(events), (std::vector{K::kAdded})) << "not found: the other one was there before";
  EXPECT_EQ(events[0].object, 1);
  const auto later = view({{1, left_}}, see_plates({left_}));
  ASSERT_EQ(kinds(later), (std::vector{K::kStillThere, K::kRemoved}));
  EXPECT_EQ(later[1].object, 0);
  EXPECT_EQ(later[1].view, 1);
}

TEST_F(ObjectHistoryTest, ConfusedWithAnotherInOneViewItIsNotRemoved) {
  view({{0, left_}}, see_plates({left_}));
  view({{1, left_}}, see_plates({left_}));
  const auto events = view({{0, left_}}, see_plates({left_}));
  EXPECT_EQ(std::ranges::count(events, K::kRemoved, &ObjectEvent::kind), 0);
  EXPECT_EQ(events[0].kind, K::kStillThere);
  EXPECT_EQ(events[0].object, 0);
}

TEST_F(ObjectHistoryTest, ReplacedByAnObjectSeenOnceItIsNotRemoved) {
  view({{0, left_}}, see_plates({left_}));
  view({{1, left_}}, see_plates({left_}));
  EXPECT_EQ(kinds(view({}, see_nothing())), (std::vector{K::kNotSeen})) << "of the other one";
  EXPECT_TRUE(history_->finish().empty());
  const std::vector<TrackedObject> known = history_->tracked_objects();
  EXPECT_EQ(known.size(), 2U);
}

TEST_F(ObjectHistoryTest, TwoOnOneSpotInOneViewAreBothFound) {
  const Rigid3 near = plate_at(-0.28, 0, 1);
  view({}, see_nothing());
  EXPECT_EQ(kinds(view({{0, left_}, {1, near}}, see_plates({left_}))), (std::vector{K::kFound, K::kFound}));
}

TEST_F(ObjectHistoryTest, AnObjectWhereAnotherWasFoundToHaveMovedAwayWasAdded) {
  view({{0, left_}}, see_plates({left_}));
  view({{0, right_}}, see_plates({left_, right_}));  // Something stands at the old place, and is not recognised.
  const auto events = view({{0, right_}, {1, left_}}, see_plates({left_, right_}));
  ASSERT_EQ(kinds(events), (std::vector{K::kMoved, K::kAdded})) << "not found";
  EXPECT_EQ(events[0].object, 0);
  EXPECT_EQ(events[1].object, 1);
}

TEST_F(ObjectHistoryTest, AnObjectWhereAnotherMovedAwayWasAdded) {
  view({{0, left_}}, see_plates({left_}));
  RgbdFrame left_is_hidden = see_plates({right_});
  hide_left_half(left_is_hidden);  // No view sees the place free.
  ASSERT_EQ(kinds(view({{0, right_}}, left_is_hidden)), (std::vector{K::kMoved}));
  EXPECT_EQ(kinds(view({{0, right_}, {1, left_}}, see_plates({left_, right_}))),
            (std::vector{K::kStillThere, K::kAdded}));
}

TEST_F(ObjectHistoryTest, AnArrivalWhosePoseIsCorrectedIsReportedAgain) {
  const Rigid3 turned = right_ * Rigid3::from_axis_angle(Eigen::Vector3d::UnitZ(), 0.7);
  view({{0, left_}}, see_plates({left_}));
  const auto reported = view({{0, turned}}, see_plates({right_}));
  ASSERT_EQ(kinds(reported), (std::vector{K::kMoved}));
  const auto events = view({{0, right_}}, see_plates({right_}));
  ASSERT_EQ(kinds(events), (std::vector{K::kStillThere, K::kMoved}));
  EXPECT_EQ(events[1].world_from_object_after->rotation, right_.rotation);
  EXPECT_DOUBLE_EQ(events[1].world_from_object_before->translation.x(), -0.3);
  ASSERT_TRUE(events[1].supersedes);
  EXPECT_EQ(events[1].supersedes->kind, K::kMoved);
  EXPECT_EQ(events[1].supersedes->track, reported[0].track);
  EXPECT_EQ(events[1].supersedes->view, 1);
  EXPECT_EQ(kinds(view({{0, right_}}, see_plates({right_}))), (std::vector{K::kStillThere})) << "once";
}

TEST_F(ObjectHistoryTest, ACorrectedArrivalIsSupersededAsItWasReportedLast) {
  const Rigid3 turned = right_ * Rigid3::from_axis_angle(Eigen::Vector3d::UnitZ(), 0.7);
  for (const bool at_once : {false, true}) {
    history_ = std::make_unique<ObjectHistory>(library_);
    view_ = 0;
    std::vector<std::vector<ObjectEvent>> all;
    all.push_back(view({{0, left_}}, see_plates({left_})));
    all.push_back(view({{0, turned}}, see_plates({left_, right_})));  // added: the old place looks taken
    if (!at_once) all.push_back(view({{0, right_}}, see_plates({left_, right_})));
    all.push_back(view({{0, right_}}, see_plates({right_})));  // moved there
    drop_superseded(all);
    std::vector<ObjectEventKind> changes;
    for (const auto& events : all)
      for (const ObjectEvent& e : events)
        if (is_change(e.kind)) changes.push_back(e.kind);
    EXPECT_EQ(changes, (std::vector{K::kMoved})) << "corrected in the same view: " << at_once;
  }
}

TEST_F(ObjectHistoryTest, ACorrectionIsCorrectedInTurn) {
  const Rigid3 turned = right_ * Rigid3::from_axis_angle(Eigen::Vector3d::UnitZ(), 0.7);
  view({{0, left_}}, see_plates({left_}));
  for (int i = 0; i < 3; ++i) view({{0, right_}}, see_plates({right_}));
  const auto wrong = view({{0, turned}}, see_plates({right_}));
  ASSERT_EQ(kinds(wrong), (std::vector{K::kStillThere, K::kMoved}));
  const auto events = view({{0, right_}}, see_plates({right_}));
  ASSERT_EQ(kinds(events), (std::vector{K::kStillThere, K::kMoved}));
  EXPECT_EQ(events[1].world_from_object_after->rotation, right_.rotation);
  EXPECT_EQ(events[1].supersedes->view, wrong[1].view);
}

TEST_F(ObjectHistoryTest, AWrongMoveIsRevoked) {
  const Rigid3 shifted = plate_at(-0.24, 0, 1);
  view({{0, left_}}, see_plates({left_}));
  ASSERT_EQ(kinds(view({{0, shifted}}, see_plates({shifted}))), (std::vector{K::kMoved}));
  const auto events = view({{0, left_}}, see_plates({plate_at(-0.26, 0, 1)}));
  ASSERT_EQ(kinds(events), (std::vector{K::kStillThere}));
  ASSERT_TRUE(events[0].supersedes);
  EXPECT_EQ(events[0].supersedes->kind, K::kMoved);
  EXPECT_EQ(events[0].supersedes->view, 1);
}

// It was added at the second place while the first one looked taken, so that one view reports both moves.
TEST_F(ObjectHistoryTest, ACorrectedSecondMoveLeavesTheFirst) {
  const Rigid3 third = plate_at(0, 0.25, 1);
  const Rigid3 turned = third * Rigid3::from_axis_angle(Eigen::Vector3d::UnitZ(), 0.7);
  for (const bool out_of_sight : {false, true}) {  // The second place: seen free, or not seen.
    history_ = std::make_unique<ObjectHistory>(library_);
    view_ = 0;
    std::vector<std::vector<ObjectEvent>> all;
    all.push_back(view({{0, left_}}, see_plates({left_})));
    all.push_back(view({{0, right_}}, see_plates({left_, right_})));
    RgbdFrame only_third = see_plates({third});
    if (out_of_sight) hide_columns(only_third, 100, 160);
    all.push_back(view({{0, turned}}, only_third));
    ASSERT_EQ(kinds(all.back()), (std::vector{K::kMoved, K::kMoved})) << out_of_sight;
    all.push_back(view({{0, third}}, see_plates({third})));
    drop_superseded(all);
    ASSERT_EQ(kinds(all[2]), (std::vector{K::kMoved})) << out_of_sight;
    EXPECT_DOUBLE_EQ(all[2][0].world_from_object_after->translation.x(), 0.3);
    ASSERT_EQ(kinds(all[3]), (std::vector{K::kStillThere, K::kMoved})) << out_of_sight;
    EXPECT_DOUBLE_EQ(all[3][1].world_from_object_before->translation.x(), 0.3);
  }
}

TEST_F(ObjectHistoryTest, LongAfterItsArrivalAnotherPoseIsNotReported) {
  const Rigid3 turned = right_ * Rigid3::from_axis_angle(Eigen::Vector3d::UnitZ(), 0.7);
  view({{0, left_}}, see_plates({left_}));
  for (int i = 0; i < 7; ++i) view({{0, turned}}, see_plates({right_}));
  EXPECT_EQ(kinds(view({{0, right_}}, see_plates({right_}))), (std::vector{K::kStillThere}));
}

}  // namespace
}  // namespace resight
