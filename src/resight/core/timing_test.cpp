// SPDX-License-Identifier: Apache-2.0
#include "resight/core/timing.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace resight {
namespace {

TEST(StageTimes, AddsUpByNameInOrderOfFirstUse) {
  StageTimes times;
  times.add("normals", 1, 2);
  times.add("sift", 0.5, 0.25);
  times.add("normals", 3, 4);
  ASSERT_EQ(times.stages().size(), 2U);
  EXPECT_EQ(times.stages()[0].stage, "normals");
  EXPECT_EQ(times.stages()[0].wall_s, 4);
  EXPECT_EQ(times.stages()[0].cpu_s, 6);
  EXPECT_EQ(times.stages()[1].stage, "sift");
  EXPECT_EQ(times.total_wall_s(), 4.5);
}

TEST(StageTimes, MergesAnotherRun) {
  StageTimes a;
  a.add("x", 1, 1);
  StageTimes b;
  b.add("y", 2, 2);
  b.add("x", 3, 3);
  a.add(b);
  ASSERT_EQ(a.stages().size(), 2U);
  EXPECT_EQ(a.stages()[0].wall_s, 4);
  EXPECT_EQ(a.total_wall_s(), 6);
  EXPECT_EQ(StageTimes().total_wall_s(), 0);
}

TEST(ScopedTimer, AddsOneEntryAtTheEndOfItsScope) {
  StageTimes times;
  double work = 0;
  {
    const ScopedTimer outer(times, "outer");
    const ScopedTimer inner(times, "inner");
    for (int i = 0; i < 1000000; ++i) work += i * 1e-9;
    EXPECT_TRUE(times.stages().empty());
  }
  EXPECT_GT(work, 0);
  ASSERT_EQ(times.stages().size(), 2U);
  EXPECT_EQ(times.stages()[0].stage, "inner");
  for (const StageTime& s : times.stages()) {
    EXPECT_GE(s.wall_s, 0);
    EXPECT_GE(s.cpu_s, 0);
  }
  EXPECT_GE(times.stages()[1].wall_s, times.stages()[0].wall_s);  // the outer scope includes the inner one
}

TEST(PeakMemoryBytes, GrowsWithWhatIsTouched) {
  const std::size_t before = peak_memory_bytes();
  ASSERT_GT(before, 1U << 20U);
  const std::vector<char> block(before + (64U << 20U), 1);
  EXPECT_GE(peak_memory_bytes(), block.size());
}

}  // namespace
}  // namespace resight
