// SPDX-License-Identifier: Apache-2.0
#include "resight/evaluation/locate_changes.hpp"

#include <gmock/gmock.h>

#include <string>
#include <vector>

namespace resight {
namespace {

using ::testing::HasSubstr;

ModelLibrary library_of_mug_and_box() {
  ModelLibrary library;
  for (const char* name : {"mug", "box"}) library.objects.emplace_back().name = name;
  return library;
}

/// A view 1 m above the origin, with mugs at these x.
TruthView see_mugs(const std::vector<double>& xs) {
  TruthView view{{Eigen::Matrix3d::Identity(), {0, 0, 1}}, {}};
  for (const double x : xs)
    view.objects.push_back({.object = "mug", .camera_from_object = {Eigen::Matrix3d::Identity(), {x, 0, -1}}});
  return view;
}

TrueChange change_at(int view, ObjectEventKind kind, const char* object = "mug") {
  return {.view = view, .kind = kind, .object = object};
}

std::vector<TrueChange> located(const std::vector<TruthView>& views, std::vector<TrueChange> changes) {
  const auto done = locate_changes(views, library_of_mug_and_box(), changes);
  EXPECT_TRUE(done.ok()) << done.error().message;
  return changes;
}

double before_x(const TrueChange& change) { return change.world_from_object_before->translation.x(); }
double after_x(const TrueChange& change) { return change.world_from_object_after->translation.x(); }

TEST(LocateChanges, PlacesAreThoseOfTheNearestViews) {
  // View 2 does not see the mug.
  const std::vector<TruthView> views{see_mugs({0.1}), see_mugs({0.2}), see_mugs({}), see_mugs({0.4}), see_mugs({})};
  const auto changes = located(views, {change_at(2, ObjectEventKind::kMoved), change_at(4, ObjectEventKind::kRemoved)});
  ASSERT_EQ(changes.size(), 2U);
  EXPECT_EQ(before_x(changes[0]), 0.2);
  EXPECT_EQ(after_x(changes[0]), 0.4);
  EXPECT_EQ(before_x(changes[1]), 0.4);
  EXPECT_FALSE(changes[1].world_from_object_after);
}

TEST(LocateChanges, WhatIsPutBackAtItsPlaceWasAway) {
  const std::vector<TruthView> views{see_mugs({0.1}), see_mugs({}), see_mugs({0.1})};
  const auto changes = located(views, {change_at(1, ObjectEventKind::kRemoved), change_at(2, ObjectEventKind::kAdded)});
  EXPECT_EQ(before_x(changes[0]), 0.1);
  EXPECT_EQ(after_x(changes[1]), 0.1);
  EXPECT_FALSE(changes[1].world_from_object_before);
}

// Annotations jitter: 5 mm are no change, 15 mm are one.
TEST(LocateChanges, OfSeveralOfAKindTheOneThatIsNotInBothViewsChanged) {
  const std::vector<TruthView> views{see_mugs({0.1, 0.2}), see_mugs({0.105, 0.215}), see_mugs({0.22}),
                                     see_mugs({0.22, 0.6})};
  const auto changes = located(views, {change_at(1, ObjectEventKind::kMoved), change_at(2, ObjectEventKind::kRemoved),
                                       change_at(3, ObjectEventKind::kAdded)});
  EXPECT_EQ(before_x(changes[0]), 0.2);
  EXPECT_EQ(after_x(changes[0]), 0.215);
  EXPECT_EQ(before_x(changes[1]), 0.105);
  EXPECT_EQ(after_x(changes[2]), 0.6);
}

TEST(LocateChanges, GivenPlacesStayAndObjectsWithoutModelAreLeftOut) {
  TrueChange given = change_at(1, ObjectEventKind::kRemoved);
  given.world_from_object_before = Rigid3::from_translation({7, 7, 7});
  TrueChange given_vase = given;
  given_vase.object = "vase";
  TruthView with_vase = see_mugs({0.1});
  with_vase.objects.push_back({.object = "vase", .camera_from_object = Rigid3::identity()});
  const auto changes =
      located({with_vase, see_mugs({})}, {given, change_at(1, ObjectEventKind::kRemoved, "vase"), given_vase});
  ASSERT_EQ(changes.size(), 2U);
  EXPECT_EQ(before_x(changes[0]), 7);
  EXPECT_EQ(changes[1].object, "vase");
}

TEST(LocateChanges, WhatTheTruthDoesNotShowIsAnError) {
  const auto fault = [](const std::vector<TruthView>& views, std::vector<TrueChange> changes) {
    const auto done = locate_changes(views, library_of_mug_and_box(), changes);
    return done ? std::string("none") : done.error().message;
  };
  using EventKind = ObjectEventKind;
  EXPECT_THAT(fault({see_mugs({0.1, 0.2}), see_mugs({0.3, 0.4})}, {change_at(1, EventKind::kMoved)}),
              HasSubstr("does not show which 'mug' was moved before view 1"));
  EXPECT_THAT(fault({see_mugs({}), see_mugs({})}, {change_at(1, EventKind::kRemoved)}), HasSubstr("was removed"));
  EXPECT_THAT(fault({}, {change_at(4, EventKind::kAdded)}), HasSubstr("was added before view 4"));
  EXPECT_THAT(fault({see_mugs({0.1}), see_mugs({0.1})}, {change_at(1, EventKind::kMoved)}), HasSubstr("was moved"))
      << "it did not move";
  EXPECT_THAT(fault({see_mugs({0.1, 0.2}), see_mugs({0.2})}, {change_at(1, EventKind::kAdded)}),
              HasSubstr("was added"));
  EXPECT_THAT(fault({see_mugs({0.1}), see_mugs({}), see_mugs({0.3})},
                    {change_at(1, EventKind::kMoved), change_at(2, EventKind::kMoved)}),
              HasSubstr("before view 1"))
      << "the place between the moves is unknown";
  EXPECT_THAT(fault({see_mugs({0.1}), see_mugs({})}, {change_at(1, EventKind::kRemoved, "Mug")}),
              HasSubstr("'Mug' is neither in the library nor in the ground truth"));
}

}  // namespace
}  // namespace resight
