// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <stdexcept>

#include "resight/changes/change_detector.hpp"

namespace resight {
namespace {

PointCloud point_at(float x) { return {.points = {{x, 0, 0}}, .normals = {}, .colors = {}}; }

std::vector<float> xs(const PointCloud& cloud) {
  std::vector<float> values;
  for (const Eigen::Vector3f& p : cloud.points) values.push_back(p.x());
  return values;
}

TEST(RemovalHistory, ARemovalConcernsTheViewsBeforeIt) {
  RemovalHistory history;
  history.add(1, point_at(1));
  history.add(3, point_at(3));
  history.add(4, {});
  EXPECT_EQ(xs(history.removed_after(-1)), (std::vector<float>{1, 3}));
  EXPECT_EQ(xs(history.removed_after(0)), (std::vector<float>{1, 3}));
  EXPECT_EQ(xs(history.removed_after(1)), (std::vector<float>{3}));  // what it saw itself is not in it
  EXPECT_EQ(xs(history.removed_after(2)), (std::vector<float>{3}));
  EXPECT_TRUE(history.removed_after(3).empty());
  EXPECT_EQ(xs(history.removed_at(3)), (std::vector<float>{3}));
  EXPECT_TRUE(history.removed_at(2).empty());
  EXPECT_TRUE(history.removed_at(4).empty());
}

TEST(RemovalHistory, ForgettingChangesNothingForTheViewsKept) {
  RemovalHistory all;
  RemovalHistory trimmed;
  for (int view = 0; view < 10; ++view)
    for (RemovalHistory* history : {&all, &trimmed}) history->add(view, point_at(static_cast<float>(view)));
  trimmed.forget_before(6);
  for (int view = 6; view < 12; ++view) {
    EXPECT_EQ(xs(trimmed.removed_after(view)), xs(all.removed_after(view)));
    EXPECT_EQ(xs(trimmed.removed_at(view)), xs(all.removed_at(view)));
  }
  EXPECT_TRUE(trimmed.removed_at(5).empty());
  EXPECT_FALSE(all.removed_at(5).empty());
}

TEST(RemovalHistory, RefusesViewsOutOfOrder) {
  RemovalHistory history;
  history.add(2, point_at(1));
  EXPECT_THROW(history.add(2, {}), std::invalid_argument);
  EXPECT_THROW(history.add(1, {}), std::invalid_argument);
}

}  // namespace
}  // namespace resight
