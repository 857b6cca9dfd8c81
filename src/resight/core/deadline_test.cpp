// SPDX-License-Identifier: Apache-2.0
#include "resight/core/deadline.hpp"

#include <gtest/gtest.h>

namespace resight {
namespace {

TEST(Deadline, PassesWhenItsClockSaysSo) {
  double now_s = 100;
  const Deadline deadline(0.5, [&] { return now_s; });
  const Deadline earlier = deadline.earlier_by(0.2);
  EXPECT_DOUBLE_EQ(deadline.left_s(), 0.5);
  now_s += 0.4;
  EXPECT_FALSE(deadline.has_passed());
  EXPECT_TRUE(earlier.has_passed());
  now_s += 0.4;
  EXPECT_TRUE(deadline.has_passed());
  EXPECT_NEAR(deadline.left_s(), -0.3, 1e-9);
}

TEST(Deadline, NoneNeverPasses) { EXPECT_FALSE(Deadline().earlier_by(1e9).has_passed()); }

TEST(SteadyClock, NeverRunsBackwards) {
  const double before_s = steady_clock_s();
  EXPECT_GE(steady_clock_s(), before_s);
}

}  // namespace
}  // namespace resight
