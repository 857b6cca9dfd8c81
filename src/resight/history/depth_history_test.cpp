// SPDX-License-Identifier: Apache-2.0
#include "resight/history/depth_history.hpp"

#include <gtest/gtest.h>

#include "resight/models/testing/square_world.hpp"

namespace resight {
namespace {

using test::kLeft;
using test::kRight;
using test::make_plate;
using test::plate_at;
using test::see_nothing;
using test::see_plates;

TEST(DepthHistory, KnowsTheLastViewThatSawAPlaceFree) {
  const PointCloud surface = make_plate("a").surface;
  DepthHistory memory;
  EXPECT_FALSE(memory.last_seen_free(surface, kLeft));
  memory.add(3, see_plates({kRight}));
  memory.add(5, see_plates({kRight}));
  memory.add(8, see_plates({kLeft}));
  memory.add(9, see_nothing());
  EXPECT_EQ(memory.last_seen_free(surface, kLeft), 5);
  EXPECT_EQ(memory.last_seen_free(surface, kRight), 8);
}

TEST(DepthHistory, ForgetsTheOldest) {
  const PointCloud surface = make_plate("a").surface;
  DepthHistory memory({.max_views = 2});
  memory.add(0, see_plates({kRight}));
  memory.add(1, see_plates({kLeft, kRight}));
  EXPECT_EQ(memory.last_seen_free(surface, kLeft), 0);
  memory.add(2, see_plates({kLeft, kRight}));
  EXPECT_FALSE(memory.last_seen_free(surface, kLeft));
}

// Each plate is as wide as 26 px: a place next to a plate is free for any thinning that leaves a few pixels of it.
TEST(DepthHistory, DownsampledViewsSeeTheSamePlaces) {
  const PointCloud surface = make_plate("a").surface;
  const RgbdFrame frame = see_plates({kLeft});
  for (const int step : {1, 2, 3, 4, 5}) {
    DepthHistory memory({}, step);
    memory.add(0, frame);
    for (double x = -0.4; x < 0.42; x += 0.05) {
      const Rigid3 place = plate_at(x, 0, 1);
      EXPECT_EQ(memory.last_seen_free(surface, place).has_value(), assess_presence(surface, place, frame).is_gone)
          << "step " << step << ", x " << x;
    }
  }
}

TEST(DepthHistory, RefusesBadOptions) {
  EXPECT_THROW(DepthHistory({.max_views = -1}), std::invalid_argument);
  EXPECT_THROW(DepthHistory({}, 0), std::invalid_argument);
}

}  // namespace
}  // namespace resight
