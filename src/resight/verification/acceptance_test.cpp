// SPDX-License-Identifier: Apache-2.0
#include "resight/verification/acceptance.hpp"

#include <gtest/gtest.h>

#include "resight/verification/failed_test.hpp"

namespace resight {
namespace {

HypothesisEvidence good_evidence() {
  HypothesisEvidence e;
  e.num_visible = 500;
  e.visible_share = 0.4;
  e.num_explained = 450;
  e.explained_share = 0.9;
  e.appearance.pattern_similarity = 0.9;
  e.appearance.shared_texture = 3;
  e.costs.explained_scene = 500;
  e.costs.outlier = 50;
  e.verdict = Verdict::kCost;
  return e;
}

AcceptanceOptions options() {
  AcceptanceOptions o;
  o.min_explained_share = 0.6;
  o.min_pattern_similarity = 0.5;
  o.min_newest_similarity = 0.4;
  o.min_shared_texture = 0.1;
  o.require_unary_gain = true;
  return o;
}

Verdict judge(double HypothesisEvidence::*field, double value, double shared_texture) {
  HypothesisEvidence e = good_evidence();
  e.appearance.shared_texture = shared_texture;
  e.*field = value;
  return assess_evidence(e, options());
}

Verdict judge(double AppearanceEvidence::*field, double value, double shared_texture) {
  HypothesisEvidence e = good_evidence();
  e.appearance.shared_texture = shared_texture;
  e.appearance.*field = value;
  return assess_evidence(e, options());
}

TEST(Acceptance, EachLimitHasItsVerdict) {
  EXPECT_EQ(assess_evidence(good_evidence(), options()), Verdict::kCost);
  EXPECT_EQ(judge(&HypothesisEvidence::visible_share, 0.09, 3), Verdict::kTooFewVisible);
  EXPECT_EQ(judge(&HypothesisEvidence::explained_share, 0.59, 3), Verdict::kNoSupport);
  EXPECT_EQ(judge(&HypothesisEvidence::explained_share, 0.61, 3), Verdict::kCost);
  EXPECT_EQ(judge(&AppearanceEvidence::pattern_similarity, 0.49, 3), Verdict::kDifferentAppearance);
  EXPECT_EQ(judge(&AppearanceEvidence::pattern_similarity, 0.51, 3), Verdict::kCost);
  EXPECT_EQ(judge(&AppearanceEvidence::newest_similarity, 0.39, 3), Verdict::kDifferentAppearance);
  EXPECT_EQ(judge(&AppearanceEvidence::newest_similarity, 0.41, 3), Verdict::kCost);
  HypothesisEvidence few = good_evidence();
  few.num_visible = 19;
  few.visible_share = 0.29;
  EXPECT_EQ(assess_evidence(few, options()), Verdict::kTooFewVisible);
}

// A box of 20 x 13 x 10 mm has 32 points, of which a camera from above sees 14.
TEST(Acceptance, SmallObjectsNeedAShareOfTheirFewPoints) {
  HypothesisEvidence small = good_evidence();
  small.num_visible = small.num_explained = 14;
  small.visible_share = 14.0 / 32;
  EXPECT_EQ(assess_evidence(small, options()), Verdict::kCost);
  small.num_visible = small.num_explained = 7;
  EXPECT_EQ(assess_evidence(small, options()), Verdict::kTooFewVisible);
}

TEST(Acceptance, TextureThatTheSceneDoesNotShareIsRejected) {
  EXPECT_EQ(judge(&AppearanceEvidence::texture_contrast, 4, 0.39), Verdict::kDifferentAppearance);
  EXPECT_EQ(judge(&AppearanceEvidence::texture_contrast, 4, 0.41), Verdict::kCost);
  EXPECT_EQ(judge(&AppearanceEvidence::texture_contrast, 0.9, 0), Verdict::kCost);  // There is no texture to share.
}

TEST(Acceptance, WhatCostsMoreThanItExplainsIsNotSelected) {
  HypothesisEvidence e = good_evidence();
  const auto may_cost = [&](double clutter, const AcceptanceOptions& o) {
    e.costs.clutter = clutter;
    return may_be_selected(e, o);
  };
  // 500 explained, 50 of outliers.
  EXPECT_TRUE(may_cost(445, options()));
  EXPECT_FALSE(may_cost(455, options()));
  AcceptanceOptions any = options();
  any.require_unary_gain = false;
  EXPECT_TRUE(may_cost(455, any));
  e.verdict = Verdict::kNoSupport;
  EXPECT_FALSE(may_cost(0, any));
}

TEST(FindFailedTest, NamesTheFirstTestWithItsNumbers) {
  EXPECT_FALSE(find_failed_test(good_evidence(), options()).has_value());
  HypothesisEvidence e = good_evidence();
  e.explained_share = 0.55;
  e.appearance.pattern_similarity = 0.1;  // fails as well, but is tested later
  const auto failed = find_failed_test(e, options());
  ASSERT_TRUE(failed.has_value());
  EXPECT_EQ(failed->verdict, Verdict::kNoSupport);
  EXPECT_STREQ(failed->quantity, "explained share");
  EXPECT_DOUBLE_EQ(failed->value, 0.55);
  EXPECT_DOUBLE_EQ(failed->limit, 0.6);
}

TEST(FindFailedTest, NamesTheGainThatIsTooSmall) {
  HypothesisEvidence e = good_evidence();
  e.costs.clutter = 460;  // gains 500 - 50 - 460
  const auto failed = find_failed_test(e, options());
  ASSERT_TRUE(failed.has_value());
  EXPECT_EQ(failed->verdict, Verdict::kCost);
  EXPECT_DOUBLE_EQ(failed->value, -10);
  EXPECT_DOUBLE_EQ(failed->limit, 0);
  EXPECT_FALSE(may_be_selected(e, options()));
}

TEST(FindFailedTest, NamesTheGainOfAnUnlikelyHypothesis) {
  HypothesisEvidence e = good_evidence();
  e.verdict = Verdict::kCost;
  e.costs.unary = 20;  // In the selection, with its small score.
  const auto failed = find_failed_test(e, options());
  ASSERT_TRUE(failed.has_value());
  EXPECT_STREQ(failed->quantity, "gain weighted by score");
  EXPECT_DOUBLE_EQ(failed->value, -20);
  EXPECT_DOUBLE_EQ(failed->limit, 0);
  e.costs.unary = -20;
  EXPECT_FALSE(find_failed_test(e, options()).has_value());
}

}  // namespace
}  // namespace resight
