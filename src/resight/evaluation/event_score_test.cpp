// SPDX-License-Identifier: Apache-2.0
#include "resight/evaluation/event_score.hpp"

#include <gtest/gtest.h>

#include "resight/evaluation/pose_at_test.hpp"

namespace resight {
namespace {

using Kind = ObjectEventKind;

ModelLibrary library_of_changes() {
  ModelLibrary library;
  library.objects.resize(2);
  library.objects[0].name = "mug";
  library.objects[0].diameter_m = 0.1F;
  library.objects[1].name = "soup";
  return library;
}

const TrueChange kMove{4, Kind::kMoved, "mug", true, pose_at(0), pose_at(0.3)};
const TrueChange kRemoval{6, Kind::kRemoved, "soup", true, pose_at(-0.3), std::nullopt};
const ChangeVisibility kAtOnce{4, 5, 3, 3};

EventScore score(const std::vector<TrueChange>& truth, const std::vector<ChangeVisibility>& visibilities,
                 const std::vector<ReportedChange>& reported) {
  return score_events(truth, visibilities, reported, library_of_changes());
}

TEST(EventScore, RightKindPlacesAndTime) {
  const EventScore s =
      score({kMove, kRemoval}, {kAtOnce, {6, -1, 5, -1}},
            {{7, Kind::kMoved, "mug", pose_at(0.01), pose_at(0.29)}, {6, Kind::kRemoved, "soup", pose_at(-0.3), {}}});
  EXPECT_EQ(s.events, (RecognitionScore{2, 0, 0}));
  EXPECT_EQ(s.departures, (RecognitionScore{2, 0, 0}));
  EXPECT_EQ(s.arrivals, (RecognitionScore{1, 0, 0}));
  EXPECT_EQ(s.delays, (std::vector<int>{0, 2}));  // Per event: the removal at once, the move two views after view 5.
}

TEST(EventScore, AMoveReportedAsRemovalAndAdditionHasItsPlacesRight) {
  const EventScore s = score({kMove}, {kAtOnce},
                             {{4, Kind::kRemoved, "mug", pose_at(0), {}}, {5, Kind::kAdded, "mug", {}, pose_at(0.3)}});
  EXPECT_EQ(s.events, (RecognitionScore{0, 2, 1}));
  EXPECT_EQ(s.departures, (RecognitionScore{1, 0, 0}));
  EXPECT_EQ(s.arrivals, (RecognitionScore{1, 0, 0}));
}

TEST(EventScore, TooEarlyElsewhereOrTwiceIsWrong) {
  EXPECT_EQ(score({kMove}, {kAtOnce}, {{3, Kind::kMoved, "mug", pose_at(0), pose_at(0.3)}}).events,
            (RecognitionScore{0, 1, 1}));
  EXPECT_EQ(score({kMove}, {kAtOnce}, {{5, Kind::kMoved, "mug", pose_at(0), pose_at(0.4)}}).events,
            (RecognitionScore{0, 1, 1}));
  EXPECT_EQ(
      score({kMove}, {kAtOnce},
            {{5, Kind::kMoved, "mug", pose_at(0), pose_at(0.3)}, {8, Kind::kMoved, "mug", pose_at(0), pose_at(0.3)}})
          .events,
      (RecognitionScore{1, 1, 0}));
}

TEST(EventScore, OfAMoveTheSideThatTheViewsShowCounts) {
  const ReportedChange as_removal{5, Kind::kRemoved, "mug", pose_at(0), {}};
  const ReportedChange as_addition{5, Kind::kAdded, "mug", {}, pose_at(0.3)};
  const ReportedChange as_move{5, Kind::kMoved, "mug", pose_at(0), pose_at(0.3)};
  const ChangeVisibility only_left{4, -1, 3, 3};
  EXPECT_EQ(score({kMove}, {only_left}, {as_removal}).events, (RecognitionScore{1, 0, 0}));
  EXPECT_EQ(score({kMove}, {only_left}, {as_move}).events, (RecognitionScore{1, 0, 0}));
  EXPECT_EQ(score({kMove}, {only_left}, {as_addition}).events, (RecognitionScore{0, 1, 1}));
  EXPECT_EQ(score({kMove}, {only_left}, {}).arrivals, (RecognitionScore{0, 0, 0}));
  const ChangeVisibility never_seen_before{4, 5, -1, 3};
  const EventScore s = score({kMove}, {never_seen_before}, {as_addition});
  EXPECT_EQ(s.events, (RecognitionScore{1, 0, 0}));
  EXPECT_EQ(s.departures, (RecognitionScore{0, 0, 0}));
  EXPECT_EQ(s.delays, (std::vector<int>{0})) << "the view of the former place does not count";
}

TEST(EventScore, WhatCouldNotBeSeenDoesNotCount) {
  const ChangeVisibility nothing{-1, -1};
  EXPECT_EQ(score({kMove}, {nothing}, {}).events, (RecognitionScore{0, 0, 0}));
  EXPECT_EQ(score({kMove}, {nothing}, {{6, Kind::kMoved, "mug", pose_at(0), pose_at(0.3)}}).events,
            (RecognitionScore{0, 0, 0}));
  const ChangeVisibility came_unseen{-1, 5, -1, -1};
  EXPECT_EQ(score({kMove}, {came_unseen}, {{6, Kind::kAdded, "mug", {}, pose_at(0.3)}}).events,
            (RecognitionScore{0, 0, 0}));
  EXPECT_EQ(score({kMove}, {came_unseen}, {{6, Kind::kRemoved, "mug", pose_at(0), {}}}).events,
            (RecognitionScore{0, 0, 0}));
  EXPECT_EQ(score({kRemoval}, {{6, -1, -1}}, {}).events, (RecognitionScore{0, 0, 0})) << "never observed before";
  EXPECT_EQ(score({kRemoval}, {{6, -1, -1}}, {}).departures, (RecognitionScore{0, 0, 0}));
  const TrueChange addition{4, Kind::kAdded, "mug", true, std::nullopt, pose_at(0.3)};
  EXPECT_EQ(score({addition}, {{-1, 5, -1, 3}}, {}).events, (RecognitionScore{0, 0, 1}));
  const ChangeVisibility first_look{-1, 5, 0, -1};  // It may have been there.
  EXPECT_EQ(score({addition}, {first_look}, {}).events, (RecognitionScore{0, 0, 0}));
  EXPECT_EQ(score({addition}, {first_look}, {}).arrivals, (RecognitionScore{0, 0, 0}));
}

// A removal that no view shows comes before an equal one that is shown.
TEST(EventScore, AReportBelongsToTheChangeThatTheViewsShow) {
  const TrueChange unseen{1, Kind::kRemoved, "mug", true, pose_at(0), std::nullopt};
  const TrueChange seen{4, Kind::kRemoved, "mug", true, pose_at(0), std::nullopt};
  const ReportedChange report{4, Kind::kRemoved, "mug", pose_at(0), {}};
  const EventScore one = score({unseen, seen}, {{-1, -1, -1, -1}, {4, -1, 3, -1}}, {report});
  EXPECT_EQ(one.events, (RecognitionScore{1, 0, 0}));
  EXPECT_EQ(one.departures, (RecognitionScore{1, 0, 0}));
  const EventScore two = score({unseen, seen}, {{-1, -1, -1, -1}, {4, -1, 3, -1}}, {report, report});
  EXPECT_EQ(two.events, (RecognitionScore{1, 0, 0})) << "the other one is of the removal that no view shows";
}

TEST(EventScore, OtherKindsAndUnknownObjectsAreNoChanges) {
  TrueChange of_stranger = kRemoval;
  of_stranger.object = "vase";
  of_stranger.known = false;
  const EventScore s =
      score({of_stranger}, {{6, -1, 5, -1}},
            {{6, Kind::kFound, "mug", {}, pose_at(0)}, {6, Kind::kStillThere, "mug", pose_at(0), pose_at(0)}});
  EXPECT_EQ(s.events, (RecognitionScore{0, 0, 0}));
}

}  // namespace
}  // namespace resight
