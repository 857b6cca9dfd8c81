// SPDX-License-Identifier: Apache-2.0
#include "resight/recognition/presence_mask.hpp"

#include <gtest/gtest.h>

#include "resight/models/testing/square_world.hpp"

namespace resight {
namespace {

using test::make_plate;
using test::plate_at;

class PresenceMaskTest : public ::testing::Test {
 protected:
  PresenceMaskTest() {
    library_.objects = {make_plate("a")};
    hypothesis_.object = 0;
    hypothesis_.world_from_object = plate_at(0, 0, 1);
    here_ = transform(hypothesis_.world_from_object, library_.objects[0].surface);
    elsewhere_ = transform(plate_at(0.5, 0, 1), library_.objects[0].surface);
  }
  std::vector<std::uint8_t> mask(int origin_view, const std::vector<ViewChanges>& window) {
    hypothesis_.origin_view = origin_view;
    return compute_presence_mask(std::span(&hypothesis_, 1), library_, window);
  }
  ModelLibrary library_;
  Hypothesis hypothesis_;
  PointCloud here_;
  PointCloud elsewhere_;
  const PointCloud nothing_;
};
using Mask = std::vector<std::uint8_t>;

TEST_F(PresenceMaskTest, WithoutChangesItMayBeEverywhere) {
  EXPECT_EQ(mask(3, {{3, &nothing_, &nothing_}, {4, nullptr, nullptr}, {5, &nothing_, &nothing_}}), (Mask{1, 1, 1}));
}

TEST_F(PresenceMaskTest, RemovedAfterItsOriginItIsAbsentFromThenOn) {
  EXPECT_EQ(mask(3, {{3, &nothing_, &nothing_}, {4, &here_, &nothing_}, {5, &nothing_, &nothing_}}), (Mask{1, 0, 0}));
}

TEST_F(PresenceMaskTest, GeneratedAgainAfterARemovalItIsNotAbsent) {
  EXPECT_EQ(mask(5, {{3, &nothing_, &nothing_}, {4, &here_, &nothing_}, {5, &nothing_, &nothing_}}), (Mask{1, 1, 1}));
}

TEST_F(PresenceMaskTest, NovelAtAViewItWasAbsentBefore) {
  EXPECT_EQ(mask(5, {{3, &nothing_, &nothing_}, {4, &nothing_, &here_}, {5, &nothing_, &nothing_}}), (Mask{0, 1, 1}));
}

TEST_F(PresenceMaskTest, PushedALittleItIsPresent) {
  PointCloud strip;  // Where its new place does not cover the old one, more is removed than is novel.
  strip.points.assign(here_.points.begin(), here_.points.begin() + static_cast<std::ptrdiff_t>(here_.size() / 2));
  EXPECT_EQ(mask(3, {{3, &nothing_, &nothing_}, {4, &here_, &strip}, {5, &nothing_, &nothing_}}), (Mask{0, 1, 1}));
}

TEST_F(PresenceMaskTest, RemovedAndPutBack) {
  EXPECT_EQ(
      mask(2, {{2, &nothing_, &nothing_}, {3, &here_, &nothing_}, {4, &nothing_, &here_}, {5, &nothing_, &nothing_}}),
      (Mask{1, 0, 1, 1}));
}

TEST_F(PresenceMaskTest, ChangesElsewhereDoNotMatter) {
  EXPECT_EQ(mask(3, {{3, &nothing_, &nothing_}, {4, &elsewhere_, &elsewhere_}}), (Mask{1, 1}));
}

TEST_F(PresenceMaskTest, ManyHypothesesAreViewMajorOnAnyNumberOfThreads) {
  std::vector<Hypothesis> hypotheses(7, hypothesis_);
  for (std::size_t h = 0; h < hypotheses.size(); ++h) {
    hypotheses[h].origin_view = 1;
    if (h % 2 == 1) hypotheses[h].world_from_object = plate_at(0.5, 0, 1);
  }
  const std::vector<ViewChanges> window{{1, &nothing_, &nothing_}, {2, &here_, &nothing_}};
  const Mask expected{1, 1, 1, 1, 1, 1, 1, 0, 1, 0, 1, 0, 1, 0};
  EXPECT_EQ(compute_presence_mask(hypotheses, library_, window, {}, 1), expected);
  EXPECT_EQ(compute_presence_mask(hypotheses, library_, window, {}, 2), expected);
}

TEST_F(PresenceMaskTest, TheLastChangeAtAPlaceCounts) {
  const auto last = [&](int seen_view, const std::vector<ViewChanges>& window) {
    const FindPlaceChange find_change = make_find_change(library_, window, {});
    EXPECT_EQ(find_change(0, plate_at(-0.5, 0, 1), seen_view), PlaceChange::kNone);
    return find_change(0, hypothesis_.world_from_object, seen_view);
  };
  EXPECT_EQ(last(3, {{4, &elsewhere_, &elsewhere_}}), PlaceChange::kNone);
  EXPECT_EQ(last(3, {{4, &here_, &nothing_}, {5, &nothing_, &nothing_}}), PlaceChange::kLeft);
  EXPECT_EQ(last(3, {{4, &here_, &nothing_}, {5, &nothing_, &here_}}), PlaceChange::kCame);
  EXPECT_EQ(last(4, {{4, &here_, &nothing_}}), PlaceChange::kNone) << "seen there when something left";
}

// Three views and three hypotheses; the current view excludes the second one.
TEST(AbsentHypotheses, AreDiscarded) {
  std::vector<Hypothesis> hypotheses(3);
  for (std::size_t h = 0; h < 3; ++h) hypotheses[h].id = h;
  Mask mask{1, 1, 0, 1, 1, 0, 1, 0, 1};
  const std::vector<Hypothesis> discarded = discard_absent(hypotheses, mask);
  EXPECT_EQ(mask, (Mask{1, 0, 1, 0, 1, 1}));
  ASSERT_EQ(discarded.size(), 1U);
  EXPECT_EQ(discarded[0].id, 1U);
  ASSERT_EQ(hypotheses.size(), 2U);
  EXPECT_EQ(hypotheses[0].id, 0U);
  EXPECT_EQ(hypotheses[1].id, 2U);
}

TEST(AbsentHypotheses, WithoutAMaskAllStay) {
  std::vector<Hypothesis> hypotheses(2);
  Mask mask;
  EXPECT_TRUE(discard_absent(hypotheses, mask).empty());
  EXPECT_EQ(hypotheses.size(), 2U);
  EXPECT_TRUE(mask.empty());
  std::vector<Hypothesis> none;
  EXPECT_TRUE(discard_absent(none, mask).empty());
}

}  // namespace
}  // namespace resight
