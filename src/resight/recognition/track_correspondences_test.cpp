// SPDX-License-Identifier: Apache-2.0
#include "resight/recognition/track_correspondences.hpp"

#include <gtest/gtest.h>

#include <array>
#include <numbers>

namespace resight {
namespace {

const Eigen::Vector3f kOnModel(0.05F, 0.02F, 0.01F);

// One hypothesis at a pose, with so many correspondences that agree with it.
std::array<Hypothesis, 1> found_in(int view, int count, const Rigid3& pose = Rigid3::identity()) {
  Hypothesis h;
  h.world_from_object = pose;
  Correspondence c;
  c.model_point = kOnModel;
  c.model_normal = c.scene_normal = Eigen::Vector3f::UnitZ();
  c.scene_point = Rigid3f(pose) * kOnModel;
  c.scene_feature = view;
  for (c.model_feature = 0; c.model_feature < count; ++c.model_feature) h.correspondences.push_back(c);
  return {h};
}

std::vector<int> views_of(const std::vector<Correspondence>& correspondences) {
  std::vector<int> views;
  for (const Correspondence& c : correspondences) views.push_back(c.scene_feature);
  return views;
}

std::vector<int> views_of(const TrackCorrespondences& track_correspondences, int track, int first_view = 0,
                          int end_view = 100) {
  return views_of(track_correspondences.of_views(track, first_view, end_view, Rigid3::identity()));
}

void add(TrackCorrespondences& track_correspondences, int track, int view, int count) {
  track_correspondences.add(track, view, found_in(view, count), Rigid3::identity(), {});
}

TEST(TrackCorrespondences, KeepsThoseOfTheLastSearches) {
  TrackCorrespondences track_correspondences(2, 0.01);
  add(track_correspondences, 7, 0, 3);
  add(track_correspondences, 7, 4, 2);
  add(track_correspondences, 7, 6, 0);  // Nothing was found: no search that counts.
  add(track_correspondences, 7, 8, 1);
  EXPECT_EQ(views_of(track_correspondences, 7), (std::vector<int>{4, 4, 8}));
}

TEST(TrackCorrespondences, LeavesOutTheWindowAndViewsOfAFormerPlace) {
  TrackCorrespondences track_correspondences(10, 0.01);
  for (int view = 0; view < 6; ++view) add(track_correspondences, 1, view, 1);
  EXPECT_EQ(views_of(track_correspondences, 1, 2, 5), (std::vector<int>{2, 3, 4}));
  EXPECT_TRUE(views_of(track_correspondences, 1, 6).empty());
}

TEST(TrackCorrespondences, EachTrackHasItsOwnUntilItIsForgotten) {
  TrackCorrespondences track_correspondences(3, 0.01);
  add(track_correspondences, 1, 0, 1);
  add(track_correspondences, 2, 1, 2);
  EXPECT_EQ(views_of(track_correspondences, 1).size(), 1U);
  EXPECT_EQ(views_of(track_correspondences, 2).size(), 2U);
  EXPECT_TRUE(views_of(track_correspondences, 3).empty());
  track_correspondences.keep_only(std::array{2});
  EXPECT_TRUE(views_of(track_correspondences, 1).empty());
  EXPECT_EQ(views_of(track_correspondences, 2).size(), 2U);
}

TEST(TrackCorrespondences, OneThatTwoGroupsShareCountsOnce) {
  TrackCorrespondences track_correspondences(3, 0.01);
  const std::vector<Hypothesis> groups{found_in(0, 2)[0], found_in(0, 3)[0]};
  track_correspondences.add(1, 0, groups, Rigid3::identity(), {});
  EXPECT_EQ(views_of(track_correspondences, 1).size(), 3U);
}

TEST(TrackCorrespondences, WhatIsForgottenIsGone) {
  TrackCorrespondences track_correspondences(3, 0.01);
  add(track_correspondences, 1, 0, 1);
  add(track_correspondences, 2, 0, 1);
  track_correspondences.forget(1);
  EXPECT_TRUE(views_of(track_correspondences, 1).empty());
  EXPECT_EQ(views_of(track_correspondences, 2).size(), 1U);
}

TEST(TrackCorrespondences, CorrespondencesFarFromThePoseAreDropped) {
  const Rigid3 shifted = Rigid3::from_translation({0.02, 0, 0});
  TrackCorrespondences track_correspondences(3, 0.01);
  track_correspondences.add(1, 0, found_in(0, 1, shifted), Rigid3::identity(), {});
  EXPECT_TRUE(views_of(track_correspondences, 1).empty());
  add(track_correspondences, 1, 1, 1);
  EXPECT_TRUE(track_correspondences.of_views(1, 0, 100, shifted).empty()) << "it was pushed since";
  EXPECT_EQ(track_correspondences.of_views(1, 0, 100, Rigid3::from_translation({0.005, 0, 0})).size(), 1U);
}

TEST(TrackCorrespondences, AHypothesisAtASymmetricPoseIsTransformed) {
  ObjectSymmetries half_turn;
  half_turn.discrete = {Rigid3::from_axis_angle(Eigen::Vector3d::UnitZ(), std::numbers::pi)};
  TrackCorrespondences track_correspondences(3, 0.01);
  const auto found = found_in(0, 1, half_turn.discrete[0]);
  track_correspondences.add(1, 0, found, Rigid3::identity(), {});
  EXPECT_TRUE(views_of(track_correspondences, 1).empty()) << "not symmetric: another pose";
  track_correspondences.add(1, 0, found, Rigid3::identity(), half_turn);
  const std::vector<Correspondence> moved = track_correspondences.of_views(1, 0, 100, Rigid3::identity());
  ASSERT_EQ(moved.size(), 1U);
  EXPECT_LT((moved[0].model_point - found[0].correspondences[0].scene_point).norm(), 1e-6F);
}

}  // namespace
}  // namespace resight
