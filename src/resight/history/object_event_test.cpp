// SPDX-License-Identifier: Apache-2.0
#include "resight/history/object_event.hpp"

#include <gtest/gtest.h>

namespace resight {
namespace {

ObjectEvent event(ObjectEventKind kind, int track, int view) {
  ObjectEvent e;
  e.kind = kind;
  e.track = track;
  e.view = view;
  return e;
}

TEST(DropSuperseded, DropsTheEventThatALaterViewCorrects) {
  std::vector<std::vector<ObjectEvent>> all{
      {event(ObjectEventKind::kRemoved, 1, 4), event(ObjectEventKind::kRemoved, 2, 4)},
      {event(ObjectEventKind::kAdded, 1, 4), event(ObjectEventKind::kMoved, 1, 7)}};
  all[1].back().supersedes = {ObjectEventKind::kRemoved, 1, 4};
  drop_superseded(all);
  ASSERT_EQ(all[0].size(), 1U);
  EXPECT_EQ(all[0][0].track, 2);
  EXPECT_EQ(all[1].size(), 2U) << "another kind, and the move itself";
}

TEST(DropSuperseded, OfTwoMovesInOneViewTheLastIsCorrected) {
  std::vector<std::vector<ObjectEvent>> all{
      {event(ObjectEventKind::kMoved, 1, 4), event(ObjectEventKind::kMoved, 1, 4)},
      {event(ObjectEventKind::kMoved, 1, 5)}};
  all[0][0].confidence = 0.5;
  all[1][0].supersedes = {ObjectEventKind::kMoved, 1, 4};
  drop_superseded(all);
  ASSERT_EQ(all[0].size(), 1U);
  EXPECT_EQ(all[0][0].confidence, 0.5);
  EXPECT_EQ(all[1].size(), 1U);
}

TEST(DropSuperseded, AcceptsARunWithoutEvents) {
  std::vector<std::vector<ObjectEvent>> all(1);
  drop_superseded(all);
  drop_superseded({});
  EXPECT_TRUE(all[0].empty());
}

}  // namespace
}  // namespace resight
