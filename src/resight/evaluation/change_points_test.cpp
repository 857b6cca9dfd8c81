// SPDX-License-Identifier: Apache-2.0
#include "resight/evaluation/change_points.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace resight {
namespace {

using Kind = ObjectEventKind;

// A plate of 20 x 20 cm facing the camera, with points 5 mm apart.
PointCloud square_plate() {
  PointCloud cloud;
  for (int i = -20; i <= 20; ++i)
    for (int k = -20; k <= 20; ++k)
      cloud.points.emplace_back(0.005F * static_cast<float>(i), 0.005F * static_cast<float>(k), 0.0F);
  return cloud;
}

constexpr double kPlateDepth_m = 1.0;
constexpr double kWallDepth_m = 1.5;
Rigid3 place() { return Rigid3::from_translation({0, 0, kPlateDepth_m}); }

// View of a camera at the origin: a wall, with or without the plate in front of it.
RgbdFrame frame(bool with_plate) {
  RgbdFrame f;
  f.camera = {160, 120, 130, 130, 79.5, 59.5};
  f.depth_m = Image<float>(160, 120, static_cast<float>(kWallDepth_m));
  for (int v = 0; with_plate && v < 120; ++v)
    for (int u = 0; u < 160; ++u) {
      const Eigen::Vector3d p = f.camera.unproject(u, v, kPlateDepth_m);
      if (std::abs(p.x()) <= 0.1 && std::abs(p.y()) <= 0.1) f.depth_m(u, v) = static_cast<float>(kPlateDepth_m);
    }
  return f;
}

PointCloud plate_in_world() { return transform(place(), square_plate()); }

class ChangePoints : public testing::Test {
 protected:
  ChangePoints() {
    library_.objects.resize(1);
    library_.objects[0].name = "plate";
    library_.objects[0].surface = square_plate();
  }
  ChangePointScorer scorer(const TrueChange& change, int num_previous_views = 3) {
    truth_.changes = std::vector<TrueChange>{change};
    return {library_, truth_, num_previous_views};
  }
  ModelLibrary library_;
  SequenceTruth truth_;
};

TEST_F(ChangePoints, ARemovedPlateIsExpectedOnceAndFound) {
  ChangePointScorer s = scorer({2, Kind::kRemoved, "plate", true, place(), std::nullopt});
  for (int v = 0; v < 2; ++v) EXPECT_EQ(s.add_view(frame(true), {}, {}).removed, ChangePointScore{});
  const ChangePointScores at_once = s.add_view(frame(false), plate_in_world(), {});
  EXPECT_EQ(at_once.removed.reported, 41 * 41);
  EXPECT_EQ(at_once.removed.right, 41 * 41);
  EXPECT_GT(at_once.removed.expected, 300);  // 21 x 21 samples 1 cm apart, minus the border.
  EXPECT_EQ(at_once.removed.found, at_once.removed.expected);
  EXPECT_EQ(at_once.novel, ChangePointScore{});
  EXPECT_EQ(s.add_view(frame(false), {}, {}).removed, ChangePointScore{});  // Not expected twice.
}

TEST_F(ChangePoints, HalfOfThePlateReportedIsHalfFound) {
  ChangePointScorer s = scorer({1, Kind::kRemoved, "plate", true, place(), std::nullopt});
  (void)s.add_view(frame(true), {}, {});
  PointCloud half;
  for (const auto& p : plate_in_world().points)
    if (p.x() < -0.02F) half.points.push_back(p);
  const ChangePointScore removed = s.add_view(frame(false), half, {}).removed;
  EXPECT_EQ(removed.precision(), 1.0);
  EXPECT_NEAR(removed.recall(), 0.5, 0.06);  // Points within 2 cm count as found, and 2 cm were left out.
}

TEST_F(ChangePoints, PointsElsewhereAreWrong) {
  ChangePointScorer s = scorer({1, Kind::kRemoved, "plate", true, place(), std::nullopt});
  (void)s.add_view(frame(true), {}, {});
  PointCloud elsewhere;
  elsewhere.points = {{0, 0, 1.03F}, {0, 0, 1.019F}, {0.5F, 0, 1}};
  const ChangePointScore removed = s.add_view(frame(false), elsewhere, {}).removed;
  EXPECT_EQ(removed.reported, 3);
  EXPECT_EQ(removed.right, 1);
}

TEST_F(ChangePoints, BeforeTheChangeNothingIsRight) {
  ChangePointScorer s = scorer({2, Kind::kRemoved, "plate", true, place(), std::nullopt});
  (void)s.add_view(frame(true), {}, {});
  EXPECT_EQ(s.add_view(frame(true), plate_in_world(), {}).removed.right, 0);
}

TEST_F(ChangePoints, WhatTheWindowHasNotSeenIsNotExpected) {
  ChangePointScorer s = scorer({1, Kind::kRemoved, "plate", true, place(), std::nullopt}, 0);
  (void)s.add_view(frame(true), {}, {});
  EXPECT_EQ(s.add_view(frame(false), {}, {}).removed.expected, 0);
}

TEST_F(ChangePoints, AnAddedPlateIsNovelWhereTheWallWasSeen) {
  ChangePointScorer s = scorer({1, Kind::kAdded, "plate", true, std::nullopt, place()});
  (void)s.add_view(frame(false), {}, {});
  const ChangePointScores scores = s.add_view(frame(true), {}, plate_in_world());
  EXPECT_GT(scores.novel.expected, 300);
  EXPECT_EQ(scores.novel.recall(), 1.0);
  EXPECT_EQ(scores.novel.precision(), 1.0);
  EXPECT_EQ(scores.removed.expected, 0);
}

TEST_F(ChangePoints, SurfacesOfUnknownThingsComeFromTheTruth) {
  truth_.unknown_surfaces["vase"] = square_plate();
  ChangePointScorer s = scorer({1, Kind::kRemoved, "vase", false, place(), std::nullopt});
  (void)s.add_view(frame(true), {}, {});
  EXPECT_GT(s.add_view(frame(false), plate_in_world(), {}).removed.found, 300);
}

}  // namespace
}  // namespace resight
