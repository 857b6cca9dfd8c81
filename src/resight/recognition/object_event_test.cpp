// SPDX-License-Identifier: Apache-2.0
#include "resight/recognition/object_event.hpp"

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

TEST(DropReplaced, DropsWhatALaterViewTellsBetter) {
  std::vector<ObjectEvent> first{event(ObjectEventKind::kRemoved, 1, 4), event(ObjectEventKind::kRemoved, 2, 4)};
  std::vector<ObjectEvent> second{event(ObjectEventKind::kAdded, 1, 4), event(ObjectEventKind::kMoved, 1, 7)};
  second.back().supersedes = {ObjectEventKind::kRemoved, 1, 4};
  std::vector<ObjectEvent>* const all[] = {&first, &second};
  drop_superseded(all);
  ASSERT_EQ(first.size(), 1U);
  EXPECT_EQ(first[0].track, 2);
  EXPECT_EQ(second.size(), 2U) << "another kind, and the move itself";
}

TEST(DropReplaced, TakesARunWithoutEvents) {
  std::vector<ObjectEvent> none;
  std::vector<ObjectEvent>* const all[] = {&none};
  drop_superseded(all);
  drop_superseded({});
  EXPECT_TRUE(none.empty());
}

}  // namespace
}  // namespace resight
