// SPDX-License-Identifier: Apache-2.0
#include "resight/evaluation/seen_changes.hpp"

#include <gtest/gtest.h>

#include "resight/evaluation/event_score.hpp"
#include "resight/evaluation/pose_at_test.hpp"

namespace resight {
namespace {

using Kind = ObjectEventKind;

const Rigid3 kA = pose_at(0), kB = pose_at(0.3), kC = pose_at(-0.3), kD = pose_at(0.6);

class SeenChangesTest : public ::testing::Test {
 protected:
  SeenChangesTest() {
    library_.objects.resize(2);
    library_.objects[0].name = "mug";
    library_.objects[1].name = "cup";
  }
  // By default, observed directly before and after it happens.
  void add(int view, Kind kind, std::optional<Rigid3> before, std::optional<Rigid3> after,
           const std::string& object = "mug") {
    changes_.push_back({view, kind, object, true, before, after});
    visibilities_.push_back({before ? view : -1, after ? view : -1, before ? view - 1 : -1, after ? view - 1 : -1});
  }
  RecognitionScore score(const std::vector<ReportedChange>& reported) {
    return score_events(changes_, visibilities_, reported, library_).events;
  }
  ModelLibrary library_;
  std::vector<TrueChange> changes_;
  std::vector<ChangeVisibility> visibilities_;
};

TEST_F(SeenChangesTest, WhichOfTwoThatLeftCameNobodyCanSee) {
  add(5, Kind::kMoved, kA, kB);
  add(5, Kind::kRemoved, kC, std::nullopt);
  EXPECT_EQ(score({{5, Kind::kMoved, "mug", kA, kB}, {5, Kind::kRemoved, "mug", kC, {}}}), (RecognitionScore{2, 0, 0}));
  EXPECT_EQ(score({{5, Kind::kMoved, "mug", kC, kB}, {5, Kind::kRemoved, "mug", kA, {}}}), (RecognitionScore{2, 0, 0}));
  EXPECT_EQ(score({{5, Kind::kMoved, "mug", kC, kB}}), (RecognitionScore{1, 0, 1}));
  EXPECT_EQ(score({{5, Kind::kMoved, "mug", kC, kD}}), (RecognitionScore{0, 1, 2})) << "nothing arrived there";
}

TEST_F(SeenChangesTest, TwoThatChangePlacesWithOthers) {
  add(5, Kind::kMoved, kA, kB);
  add(5, Kind::kMoved, kC, kD);
  EXPECT_EQ(score({{5, Kind::kMoved, "mug", kA, kD}, {5, Kind::kMoved, "mug", kC, kB}}), (RecognitionScore{2, 0, 0}));
  changes_[1].object = "cup";
  EXPECT_EQ(score({{5, Kind::kMoved, "mug", kA, kD}, {5, Kind::kMoved, "cup", kC, kB}}), (RecognitionScore{0, 2, 2}))
      << "objects of two kinds are distinguishable";
}

TEST_F(SeenChangesTest, RemovedAndAddedIsAMoveUnlessAViewShowsBothPlacesFree) {
  add(5, Kind::kRemoved, kA, std::nullopt);
  add(8, Kind::kAdded, std::nullopt, kB);
  const std::vector<ReportedChange> as_move = {{9, Kind::kMoved, "mug", kA, kB}};
  EXPECT_EQ(score(as_move), (RecognitionScore{0, 1, 2})) << "kA is free from view 5 on, kB until view 7";
  visibilities_[0].before_view = 9;  // The former place is observed later.
  EXPECT_EQ(score(as_move), (RecognitionScore{1, 0, 0}));
  EXPECT_EQ(score({{9, Kind::kRemoved, "mug", kA, {}}, {9, Kind::kAdded, "mug", {}, kB}}), (RecognitionScore{2, 0, 0}))
      << "as it happened";
  EXPECT_EQ(score({{7, Kind::kMoved, "mug", kA, kB}}), (RecognitionScore{0, 1, 2})) << "before it arrived";
  visibilities_[0].before_view = 8;
  EXPECT_EQ(score(as_move), (RecognitionScore{1, 0, 0}));
  visibilities_[1].last_free_view = 4;
  visibilities_[0].before_view = 5;
  EXPECT_EQ(score(as_move), (RecognitionScore{1, 0, 0})) << "the new place was not observed after view 4";
}

TEST_F(SeenChangesTest, WhatIsThereBeforeTheOtherLeavesIsAnother) {
  add(5, Kind::kAdded, std::nullopt, kB);
  add(8, Kind::kRemoved, kA, std::nullopt);
  EXPECT_EQ(score({{8, Kind::kMoved, "mug", kA, kB}}), (RecognitionScore{0, 1, 2}));
  visibilities_[1].last_there_view = 3;  // It has not been observed at kA since.
  EXPECT_EQ(score({{8, Kind::kMoved, "mug", kA, kB}}), (RecognitionScore{1, 0, 0}));
}

TEST_F(SeenChangesTest, AStopThatNoViewShowsIsLeftOut) {
  add(3, Kind::kMoved, kA, kB);
  add(6, Kind::kMoved, kB, kC);
  visibilities_[0] = {7, -1, 2, 1};  // kA is observed free at view 7; the object is never observed at kB.
  visibilities_[1] = {7, 7, -1, 2};
  EXPECT_EQ(score({{7, Kind::kMoved, "mug", kA, kC}}), (RecognitionScore{1, 0, 0}));
  EXPECT_EQ(score({}), (RecognitionScore{0, 0, 2}));
}

TEST_F(SeenChangesTest, WhatFitsAsItIsStays) {
  add(5, Kind::kMoved, kA, kB);
  add(5, Kind::kMoved, kC, kD);
  const std::vector<ReportedChange> reports = {{5, Kind::kMoved, "mug", kA, kB}, {6, Kind::kMoved, "mug", kA, kD}};
  EXPECT_EQ(score(reports), (RecognitionScore{1, 1, 1})) << "kA is occupied";
}

TEST_F(SeenChangesTest, WithoutAReportTheChangesAreAsTheyWere) {
  add(5, Kind::kMoved, kA, kB);
  add(5, Kind::kRemoved, kC, std::nullopt);
  std::vector<SeenChange> truths;
  for (std::size_t i = 0; i < changes_.size(); ++i) truths.push_back({changes_[i], visibilities_[i]});
  const MatchDetectionsOptions options;
  const auto reported = reconcile_with_reports(truths, {}, ChangeMatcher(library_, options));
  ASSERT_EQ(reported.size(), 2U);
  EXPECT_EQ(reported[0].kind, Kind::kMoved);
  EXPECT_EQ(reported[1].kind, Kind::kRemoved);
}

}  // namespace
}  // namespace resight
