// SPDX-License-Identifier: Apache-2.0
#include "resight/recognition/time_budget.hpp"

#include <gtest/gtest.h>

#include <limits>

namespace resight {
namespace {

// Hypotheses with 0, 1, 2, ... correspondences.
std::vector<Hypothesis> make_hypotheses(std::size_t count) {
  std::vector<Hypothesis> hypotheses(count);
  for (std::size_t h = 0; h < count; ++h) {
    hypotheses[h].id = h;
    hypotheses[h].correspondences.resize(h);
  }
  return hypotheses;
}

std::vector<std::uint64_t> ids_of(const std::vector<Hypothesis>& hypotheses) {
  std::vector<std::uint64_t> ids;
  for (const Hypothesis& h : hypotheses) ids.push_back(h.id);
  return ids;
}

// What was left out; empty if nothing was.
std::string drop_late(const TimeBudget& budget, std::vector<Hypothesis>& hypotheses,
                      const TimeBudget::IsTracked& is_tracked) {
  std::vector<std::string> left_out;
  budget.drop_late(hypotheses, is_tracked, left_out);
  return left_out.empty() ? "" : left_out.front();
}

const TimeBudget::IsTracked kNoneTracked = [](const Hypothesis&) { return false; };

// A clock that the test sets, and a budget that has verified one view of 20 hypotheses in 0.2 s.
class TimeBudgetTest : public ::testing::Test {
 protected:
  TimeBudgetTest() {
    budget_.start_view();
    budget_.start_verification();
    now_s_ += 0.2;
    budget_.finish_verification(20);
    budget_.start_view();
  }
  double now_s_ = 100;
  TimeBudget budget_{500, [this] { return now_s_; }};
};

TEST_F(TimeBudgetTest, TheSearchLeavesTheTimeOfTheLastVerification) {
  EXPECT_NEAR(budget_.search_deadline().left_s(), 0.3, 1e-12);
  now_s_ += 0.31;
  EXPECT_TRUE(budget_.search_deadline().has_passed());
}

TEST_F(TimeBudgetTest, KeepsWhatThePaceOfTheLastViewAllows) {
  now_s_ += 0.345;  // 0.155 s are left: 15 hypotheses of 10 ms.
  std::vector<Hypothesis> hypotheses = make_hypotheses(20);
  EXPECT_EQ(drop_late(budget_, hypotheses, kNoneTracked), "verification of 5 of 20 hypotheses");
  ASSERT_EQ(hypotheses.size(), 15U);
  EXPECT_EQ(hypotheses.front().id, 19U) << "most correspondences first";
  EXPECT_EQ(hypotheses.back().id, 5U);
}

TEST_F(TimeBudgetTest, KeepsTheOrderIfThereIsTimeForAll) {
  std::vector<Hypothesis> hypotheses = make_hypotheses(20);
  EXPECT_EQ(drop_late(budget_, hypotheses, kNoneTracked), "");
  EXPECT_EQ(ids_of(hypotheses), ids_of(make_hypotheses(20)));
}

TEST_F(TimeBudgetTest, HoweverLateItKeepsTenAndAllTrackedOnes) {
  now_s_ += 10;
  std::vector<Hypothesis> hypotheses = make_hypotheses(20);
  EXPECT_EQ(drop_late(budget_, hypotheses, [](const Hypothesis& h) { return h.id < 3; }),
            "verification of 10 of 20 hypotheses");
  EXPECT_EQ(ids_of(hypotheses), (std::vector<std::uint64_t>{2, 1, 0, 19, 18, 17, 16, 15, 14, 13}));
  hypotheses = make_hypotheses(20);
  EXPECT_EQ(drop_late(budget_, hypotheses, [](const Hypothesis& h) { return h.id < 12; }),
            "verification of 8 of 20 hypotheses");
  EXPECT_EQ(hypotheses.size(), 12U);
  hypotheses = make_hypotheses(7);
  EXPECT_EQ(drop_late(budget_, hypotheses, kNoneTracked), "");
  EXPECT_EQ(ids_of(hypotheses), ids_of(make_hypotheses(7)));
}

TEST(TimeBudget, WithoutADeadlineThereIsAlwaysTime) {
  double now_s = 0;
  TimeBudget budget(std::nullopt, [&] { return now_s += 1000; });
  budget.start_view();
  budget.start_verification();
  budget.finish_verification(1);
  EXPECT_EQ(budget.search_deadline().left_s(), std::numeric_limits<double>::infinity());
  std::vector<Hypothesis> hypotheses = make_hypotheses(50);
  EXPECT_EQ(drop_late(budget, hypotheses, kNoneTracked), "");
  EXPECT_EQ(hypotheses.size(), 50U);
}

TEST(TimeBudget, TheFirstViewHasNoPaceYet) {
  double now_s = 0;
  TimeBudget budget(500, [&] { return now_s; });
  budget.start_view();
  std::vector<Hypothesis> hypotheses = make_hypotheses(1000);
  EXPECT_EQ(drop_late(budget, hypotheses, kNoneTracked), "");
  budget.start_verification();
  budget.finish_verification(0);  // A view without hypotheses says nothing of the pace.
  EXPECT_EQ(drop_late(budget, hypotheses, kNoneTracked), "");
}

}  // namespace
}  // namespace resight
