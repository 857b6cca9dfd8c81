// SPDX-License-Identifier: Apache-2.0
#include "resight/evaluation/placement_changes.hpp"

#include <gtest/gtest.h>

#include "resight/evaluation/pose_at_test.hpp"
#include "resight/sensor/testing/memory_sequence.hpp"

namespace resight {
namespace {

using Kind = ObjectEventKind;

// A placement at x from the first to the last view.
AnnotatedPlacement placed(const std::string& object, int first, int last, double x) {
  return {object, first, last, pose_at(x), pose_at(x)};
}
// The view that first shows the place left, and the last view before the placement that shows it free; -1 = none.
ChangeVisibility seen(int gone, int free) { return {gone, -1, -1, free}; }

struct Expected {
  int view;
  Kind kind;
  double before_x;  // Ignored for additions.
  double after_x;   // Ignored for removals.
};

void expect_changes(const PlacementChanges& result, const std::vector<Expected>& expected) {
  ASSERT_EQ(result.changes.size(), expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i) {
    const TrueChange& change = result.changes[i];
    EXPECT_EQ(change.view, expected[i].view) << i;
    EXPECT_EQ(change.kind, expected[i].kind) << i;
    ASSERT_EQ(change.world_from_object_before.has_value(), change.kind != Kind::kAdded);
    ASSERT_EQ(change.world_from_object_after.has_value(), change.kind != Kind::kRemoved);
    if (change.world_from_object_before) {
      EXPECT_EQ(change.world_from_object_before->translation.x(), expected[i].before_x) << i;
    }
    if (change.world_from_object_after) {
      EXPECT_EQ(change.world_from_object_after->translation.x(), expected[i].after_x) << i;
    }
  }
}

TEST(InferChanges, WhatNoViewProvesIsNoChange) {
  const std::vector<AnnotatedPlacement> placements = {placed("mug", 0, 2, 0), placed("tin", 3, 5, 1)};
  const auto unknown = infer_changes(placements, std::vector{seen(-1, -1), seen(-1, -1)});
  EXPECT_TRUE(unknown.changes.empty()) << "out of the image, and into it";
  EXPECT_EQ(unknown.has_left, (std::vector<char>{0, 0}));
  const auto proven = infer_changes(placements, std::vector{seen(4, -1), seen(-1, 1)});
  expect_changes(proven, {{2, Kind::kAdded, 0, 1}, {3, Kind::kRemoved, 0, 0}});
  EXPECT_EQ(proven.has_left, (std::vector<char>{1, 0}));
}

TEST(InferChanges, OneCopyThatTurnsUpElsewhereHasMoved) {
  const std::vector<AnnotatedPlacement> placements = {placed("mug", 0, 2, 0), placed("mug", 6, 8, 1)};
  for (const int gone : {-1, 5})
    for (const int free : {-1, 4}) {
      const auto result = infer_changes(placements, std::vector{seen(gone, -1), seen(-1, free)});
      expect_changes(result, {{std::max(2, free) + 1, Kind::kMoved, 0, 1}});
      EXPECT_EQ(result.has_left, (std::vector<char>{1, 0}));
    }
}

// Both places were seen without it at one time, so it was away.
TEST(InferChanges, OneCopyThatWasAwayWasRemovedAndAdded) {
  const std::vector<AnnotatedPlacement> placements = {placed("mug", 0, 2, 0), placed("mug", 6, 8, 1)};
  expect_changes(infer_changes(placements, std::vector{seen(4, -1), seen(-1, 4)}),
                 {{3, Kind::kRemoved, 0, 0}, {5, Kind::kAdded, 0, 1}});
}

TEST(InferChanges, TwoCopiesAreToldApartWhereTheViewsAllowIt) {
  // Two mugs are there in view 7. The one at x = 2 may have been there all along if nobody looked, so the one at x = 3
  // is the one that left x = 0.
  std::vector<AnnotatedPlacement> placements = {placed("mug", 0, 2, 0), placed("mug", 5, 8, 2), placed("mug", 7, 9, 3)};
  expect_changes(infer_changes(placements, std::vector{seen(3, -1), seen(-1, -1), seen(-1, -1)}),
                 {{3, Kind::kMoved, 0, 3}});
  // If x = 2 was seen free while x = 0 was not yet seen free, that one moved.
  expect_changes(infer_changes(placements, std::vector{seen(4, -1), seen(-1, 3), seen(-1, -1)}),
                 {{4, Kind::kMoved, 0, 2}});
  // Once both were seen, a further placement must be of the one that is not at its place.
  placements.push_back(placed("mug", 9, 9, 4));
  expect_changes(infer_changes(placements, std::vector{seen(3, -1), seen(-1, -1), seen(-1, -1), seen(-1, -1)}),
                 {{3, Kind::kMoved, 0, 3}, {9, Kind::kMoved, 2, 4}});
}

// Of two copies that left, the one that was seen gone first turned up first.
TEST(InferChanges, OfTwoCopiesThatLeftTheFirstTurnsUpFirst) {
  const std::vector<AnnotatedPlacement> placements = {placed("mug", 0, 2, 0), placed("mug", 0, 2, 1),
                                                      placed("mug", 5, 8, 2), placed("mug", 6, 8, 3)};
  expect_changes(infer_changes(placements, std::vector{seen(6, -1), seen(4, -1), seen(-1, 3), seen(-1, 5)}),
                 {{4, Kind::kMoved, 1, 2}, {6, Kind::kMoved, 0, 3}});
}

TEST(InferChanges, RefusesOtherNumbers) {
  EXPECT_THROW((void)infer_changes(std::vector{placed("mug", 0, 2, 0)}, {}), std::invalid_argument);
}

// A camera that looks along z at a wall, at x; its image ends 0.6 m beside x in 1 m distance.
RgbdFrame frame_at(double x) {
  RgbdFrame frame;
  frame.camera = {64, 48, 50, 50, 31.5, 23.5};
  frame.depth_m = Image<float>(64, 48, 2.0F);
  frame.world_from_camera = pose_at(x, 0, 0);
  return frame;
}

TEST(ObservePlacements, ThePlaceMustBeInTheImage) {
  ModelLibrary library;
  library.objects.resize(1);
  library.objects[0].name = "mug";
  library.objects[0].diameter_m = 0.1F;
  const std::vector<double> camera_x = {0, 2, 0, 2};
  std::vector<TruthView> views;
  std::vector<RgbdFrame> frames;
  for (const double x : camera_x) {
    frames.push_back(frame_at(x));
    views.push_back({frames.back().world_from_camera, {}});
  }
  GroundTruthObject mug;
  mug.object = "mug";
  mug.camera_from_object = pose_at(0);
  views[0].objects = {mug};
  views[3].objects = {mug};
  const std::vector<AnnotatedPlacement> placements = {placed("mug", 0, 0, 0), placed("mug", 3, 3, 2)};
  const auto seen = observe_placements(placements, views, test::MemorySequence(frames), library);
  ASSERT_TRUE(seen.ok()) << seen.error().message;
  EXPECT_EQ((*seen)[0].before_view, 2);
  EXPECT_EQ((*seen)[0].last_there_view, 0);
  EXPECT_EQ((*seen)[1].last_free_view, 1);
  EXPECT_EQ((*seen)[1].after_view, 3);
  frames[2].depth_m = {};
  EXPECT_EQ(observe_placements(placements, views, test::MemorySequence(frames), library).error().message,
            "view 2 cannot be read");
}

}  // namespace
}  // namespace resight
