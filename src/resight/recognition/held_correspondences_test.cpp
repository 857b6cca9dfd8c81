// SPDX-License-Identifier: Apache-2.0
#include "resight/recognition/held_correspondences.hpp"

#include <gtest/gtest.h>

#include <array>

namespace resight {
namespace {

std::vector<Correspondence> found_in(int view, int count) {
  std::vector<Correspondence> found(static_cast<std::size_t>(count));
  for (Correspondence& c : found) c.scene_feature = view;
  return found;
}

std::vector<int> views_of(const std::vector<Correspondence>& correspondences) {
  std::vector<int> views;
  for (const Correspondence& c : correspondences) views.push_back(c.scene_feature);
  return views;
}

TEST(HeldCorrespondences, ThoseOfTheLastSearchesAreHeld) {
  HeldCorrespondences held(2);
  held.add(7, 0, found_in(0, 3));
  held.add(7, 4, found_in(4, 2));
  held.add(7, 8, found_in(8, 1));
  EXPECT_EQ(views_of(held.of_views(7, 0, 100)), (std::vector<int>{4, 4, 8}));
}

TEST(HeldCorrespondences, WhatTheWindowHoldsAndWhatWasBeforeItsPlaceIsLeftOut) {
  HeldCorrespondences held(10);
  for (int view = 0; view < 6; ++view) held.add(1, view, found_in(view, 1));
  EXPECT_EQ(views_of(held.of_views(1, 2, 5)), (std::vector<int>{2, 3, 4}));
  EXPECT_TRUE(held.of_views(1, 6, 100).empty());
}

TEST(HeldCorrespondences, EachTrackHasItsOwnUntilItIsForgotten) {
  HeldCorrespondences held(3);
  held.add(1, 0, found_in(0, 1));
  held.add(2, 1, found_in(1, 2));
  EXPECT_EQ(held.of_views(1, 0, 9).size(), 1U);
  EXPECT_EQ(held.of_views(2, 0, 9).size(), 2U);
  EXPECT_TRUE(held.of_views(3, 0, 9).empty());
  held.keep_only(std::array{2});
  EXPECT_TRUE(held.of_views(1, 0, 9).empty());
  EXPECT_EQ(held.of_views(2, 0, 9).size(), 2U);
}

}  // namespace
}  // namespace resight
