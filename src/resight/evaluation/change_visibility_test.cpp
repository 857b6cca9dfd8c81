// SPDX-License-Identifier: Apache-2.0
#include "resight/evaluation/change_visibility.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "resight/evaluation/pose_at_test.hpp"

namespace resight {
namespace {

using Kind = ObjectEventKind;

ModelLibrary library_of_seen() {
  ModelLibrary library;
  ObjectModel& mug = library.objects.emplace_back();
  mug.name = "mug";
  mug.diameter_m = 0.1F;
  return library;
}

GroundTruthObject mug_at(double x, double visible_share) {
  GroundTruthObject mug;
  mug.object = "mug";
  mug.camera_from_object = pose_at(x);
  mug.visible_share = visible_share;
  return mug;
}

// A mug that is moved from one place to another before the second view.
SequenceTruth move_mug(std::size_t num_views) {
  SequenceTruth truth;
  truth.changes = std::vector<TrueChange>{{1, Kind::kMoved, "mug", true, pose_at(0), pose_at(0.3)}};
  truth.views.resize(num_views);
  return truth;
}

// A camera at the origin that looks along z at a wall.
RgbdFrame frame_with_wall(float depth_m) {
  RgbdFrame frame;
  frame.camera = {64, 48, 50, 50, 31.5, 23.5};
  frame.depth_m = Image<float>(64, 48, depth_m);
  return frame;
}

TEST(ChangeVisibilityFinder, AHiddenPlaceIsNotSeen) {
  const ModelLibrary library = library_of_seen();
  SequenceTruth truth = move_mug(4);
  truth.views[0].objects = {mug_at(0, 0.5)};
  truth.views[1].objects = truth.views[2].objects = {mug_at(0.3, 0.02)};  // Still occluded.
  truth.views[3].objects = {mug_at(0.3, 0.5)};
  ChangeVisibilityFinder finder(library, truth);
  EXPECT_EQ(finder.visibilities()[0].last_there_view, -1);
  EXPECT_EQ(finder.visibilities()[0].last_free_view, -1);
  finder.add_view(frame_with_wall(2.0F));  // Before the change.
  EXPECT_EQ(finder.visibilities()[0].before_view, -1);
  EXPECT_EQ(finder.visibilities()[0].last_there_view, 0);
  EXPECT_EQ(finder.visibilities()[0].last_free_view, 0);
  finder.add_view(frame_with_wall(0.7F));  // The place is occluded.
  EXPECT_EQ(finder.visibilities()[0].before_view, -1);
  finder.add_view(frame_with_wall(2.0F));
  EXPECT_EQ(finder.visibilities()[0].before_view, 2);
  EXPECT_EQ(finder.visibilities()[0].after_view, -1);
  finder.add_view(frame_with_wall(std::numeric_limits<float>::quiet_NaN()));
  EXPECT_EQ(finder.visibilities()[0].before_view, 2);
  EXPECT_EQ(finder.visibilities()[0].after_view, 3);
}

// The mug was visible there, left, and returned unobserved: no view can show its second departure.
TEST(ChangeVisibilityFinder, WhatWasSeenBeforeItCameBackWasNotSeen) {
  const ModelLibrary library = library_of_seen();
  SequenceTruth truth;
  truth.changes = std::vector<TrueChange>{{1, Kind::kMoved, "mug", true, pose_at(0), pose_at(0.3)},
                                          {2, Kind::kMoved, "mug", true, pose_at(0.3), pose_at(0)},
                                          {4, Kind::kMoved, "mug", true, pose_at(0), pose_at(-0.3)}};
  truth.views.resize(5);
  truth.views[0].objects = {mug_at(0, 0.5)};
  truth.views[2].objects = truth.views[3].objects = {mug_at(0, 0.02)};
  ChangeVisibilityFinder finder(library, truth);
  for (int v = 0; v < 5; ++v) finder.add_view(frame_with_wall(2.0F));
  EXPECT_EQ(finder.visibilities()[0].last_there_view, 0);
  EXPECT_EQ(finder.visibilities()[2].last_there_view, -1);
}

// While no view looked, the mug left, came back and left again, or came, left and came again. Only one of two equal
// changes can have been seen.
TEST(ChangeVisibilityFinder, WhatIsSeenAfterALaterChangeDoesNotShowTheEarlierOne) {
  const ModelLibrary library = library_of_seen();
  SequenceTruth truth;
  truth.changes = std::vector<TrueChange>{{1, Kind::kRemoved, "mug", true, pose_at(0), {}},
                                          {2, Kind::kAdded, "mug", true, {}, pose_at(0)},
                                          {4, Kind::kRemoved, "mug", true, pose_at(0), {}}};
  truth.views.resize(6);
  for (const int v : {0, 3}) truth.views[static_cast<std::size_t>(v)].objects = {mug_at(0, 0.5)};
  truth.views[2].objects = {mug_at(0, 0.02)};
  ChangeVisibilityFinder away(library, truth);
  for (const float depth_m : {2.0F, 0.7F, 0.7F, 2.0F, 2.0F, 2.0F}) away.add_view(frame_with_wall(depth_m));
  EXPECT_EQ(away.visibilities()[0].before_view, -1);
  EXPECT_EQ(away.visibilities()[1].last_free_view, -1);
  EXPECT_EQ(away.visibilities()[1].after_view, 3);
  EXPECT_EQ(away.visibilities()[2].last_there_view, 3);
  EXPECT_EQ(away.visibilities()[2].before_view, 4);

  truth.changes = std::vector<TrueChange>{{1, Kind::kAdded, "mug", true, {}, pose_at(0)},
                                          {2, Kind::kRemoved, "mug", true, pose_at(0), {}},
                                          {3, Kind::kAdded, "mug", true, {}, pose_at(0)}};
  truth.views.assign(5, {});
  truth.views[1].objects = {mug_at(0, 0.02)};
  truth.views[4].objects = {mug_at(0, 0.5)};
  ChangeVisibilityFinder back(library, truth);
  for (const float depth_m : {2.0F, 0.7F, 0.7F, 0.7F, 2.0F}) back.add_view(frame_with_wall(depth_m));
  EXPECT_EQ(back.visibilities()[0].last_free_view, 0);
  EXPECT_EQ(back.visibilities()[0].after_view, -1);
  EXPECT_EQ(back.visibilities()[2].last_free_view, -1);
  EXPECT_EQ(back.visibilities()[2].after_view, 4);
}

// One mug takes the place of another one at the same moment.
TEST(ChangeVisibilityFinder, AnArrivalWhereAnotherLeavesIsSeen) {
  const ModelLibrary library = library_of_seen();
  SequenceTruth truth;
  truth.changes = std::vector<TrueChange>{{1, Kind::kMoved, "mug", true, pose_at(0), pose_at(0.3)},
                                          {1, Kind::kMoved, "mug", true, pose_at(0.3), pose_at(-0.3)}};
  truth.views.resize(2);
  truth.views[0].objects = {mug_at(0, 0.5), mug_at(0.3, 0.5)};
  truth.views[1].objects = {mug_at(0.3, 0.5), mug_at(-0.3, 0.5)};
  ChangeVisibilityFinder finder(library, truth);
  for (int v = 0; v < 2; ++v) finder.add_view(frame_with_wall(2.0F));
  EXPECT_EQ(finder.visibilities()[0].before_view, 1);
  EXPECT_EQ(finder.visibilities()[0].after_view, 1);
  EXPECT_EQ(finder.visibilities()[1].before_view, -1);
  EXPECT_EQ(finder.visibilities()[1].after_view, 1);
}

// Another mug is at the new place before, and at the former place after the change: no view shows either place without
// one.
TEST(ChangeVisibilityFinder, APlaceWhereOneOfItsKindStandsIsNotFree) {
  const ModelLibrary library = library_of_seen();
  SequenceTruth truth = move_mug(2);
  truth.views[0].objects = {mug_at(0.3, 0.5)};
  truth.views[1].objects = {mug_at(0, 0.5)};
  ChangeVisibilityFinder finder(library, truth);
  for (int v = 0; v < 2; ++v) finder.add_view(frame_with_wall(2.0F));
  EXPECT_EQ(finder.visibilities()[0].last_free_view, -1);
  EXPECT_EQ(finder.visibilities()[0].before_view, -1);
}

TEST(ChangeVisibilityFinder, AnObjectThatWasHiddenBeforeWasNotSeen) {
  const ModelLibrary library = library_of_seen();
  SequenceTruth truth = move_mug(1);
  truth.views[0].objects = {mug_at(0, 0.02)};
  ChangeVisibilityFinder finder(library, truth);
  finder.add_view(frame_with_wall(0.7F));
  EXPECT_EQ(finder.visibilities()[0].last_there_view, -1);
  EXPECT_EQ(finder.visibilities()[0].last_free_view, -1);
}

}  // namespace
}  // namespace resight
