// SPDX-License-Identifier: Apache-2.0
#include "resight/sensor/color_offset.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "resight/core/random.hpp"

namespace resight {
namespace {

const Camera kOffsetCamera{320, 240, 280, 280, 159.5, 119.5};

bool is_on_board(int u, int v) {
  const auto within = [&](int from_u, int from_v) {
    return u >= from_u && u < from_u + 50 && v >= from_v && v < from_v + 60;
  };
  return within(30, 30) || within(120, 140) || within(200, 40) || within(240, 150);
}

/// Boards before a wall, whose colours lie `offset` beside the depth. Depth is lost within `lost_px` of the contours.
RgbdFrame see_boards(Eigen::Vector2i offset_px, int lost_px = 0, std::uint64_t seed = 1) {
  RgbdFrame frame{"boards", kOffsetCamera, Image<Rgb8>(320, 240), Image<float>(320, 240), Rigid3::identity()};
  Rng rng(seed);
  for (int v = 0; v < 240; ++v)
    for (int u = 0; u < 320; ++u) {
      const double noise = 3 * rng.normal();
      const int level = static_cast<int>((is_on_board(u - offset_px.x(), v - offset_px.y()) ? 150 : 90) + noise);
      frame.color(u, v) = {static_cast<std::uint8_t>(level), static_cast<std::uint8_t>(level), 100};
      frame.depth_m(u, v) = is_on_board(u, v) ? 1.0F : 1.5F;
      if (is_on_board(u, v) && !(is_on_board(u - lost_px, v) && is_on_board(u + lost_px, v) &&
                                 is_on_board(u, v - lost_px) && is_on_board(u, v + lost_px)))
        frame.depth_m(u, v) = std::numeric_limits<float>::quiet_NaN();
    }
  return frame;
}

TEST(MeasureColorOffset, FindsTheShiftOfTheColors) {
  for (const Eigen::Vector2i& offset_px : {Eigen::Vector2i(0, 0), Eigen::Vector2i(2, -1), Eigen::Vector2i(-3, 2)})
    for (const int lost_px : {0, 2}) {
      const auto measured = measure_color_offset(prepare_view(see_boards(offset_px, lost_px)));
      ASSERT_TRUE(measured.has_value()) << offset_px.transpose() << ", lost " << lost_px;
      EXPECT_LT((*measured - offset_px.cast<double>()).norm(), 0.2) << measured->transpose() << ", lost " << lost_px;
    }
}

TEST(MeasureColorOffset, NothingWithoutContoursColorsOrAgreement) {
  RgbdFrame flat = see_boards({0, 0});
  std::ranges::fill(flat.depth_m.data(), 1.5F);
  EXPECT_FALSE(measure_color_offset(prepare_view(flat)).has_value());
  RgbdFrame grey = see_boards({0, 0});
  std::ranges::fill(grey.color.data(), Rgb8{90, 90, 90});
  EXPECT_FALSE(measure_color_offset(prepare_view(grey)).has_value());
  RgbdFrame blind = see_boards({0, 0});
  std::ranges::fill(blind.depth_m.data(), std::numeric_limits<float>::quiet_NaN());
  EXPECT_FALSE(measure_color_offset(prepare_view(blind)).has_value());
  EXPECT_FALSE(measure_color_offset(prepare_view(see_boards({9, 0}))).has_value()) << "beyond the reach of the search";
}

TEST(ColorOffsetCorrector, MovesTheColorsOntoTheDepthOnceItIsSure) {
  ColorOffsetCorrector corrector({.correct = true});
  for (std::uint64_t view = 1; view <= 4; ++view) {
    PreparedView prepared = prepare_view(see_boards({2, -1}, 1, view));
    const ColorOffset offset = corrector.correct(prepared);
    EXPECT_EQ(offset.num_views, static_cast<int>(view));
    const bool sure = view >= 3;
    EXPECT_EQ(offset.moved_px, sure ? Eigen::Vector2i(2, -1) : Eigen::Vector2i(0, 0));
    EXPECT_NEAR(prepared.frame.color(31, 60).r, sure ? 150 : 90, 20) << "a pixel of a board, near its left border";
  }
}

TEST(ColorOffsetCorrector, LeavesColorsThatAreRightOrUncertain) {
  ColorOffsetCorrector exact({.correct = true});
  ColorOffsetCorrector uncertain({.correct = true});
  ColorOffsetCorrector off;
  for (int view = 0; view < 6; ++view) {
    const auto seed = static_cast<std::uint64_t>(view + 1);
    const PreparedView right = prepare_view(see_boards({0, 0}, 1, seed));
    PreparedView seen = right;
    (void)exact.correct(seen);
    EXPECT_EQ(seen.frame.color, right.frame.color);
    const PreparedView jumping = prepare_view(see_boards({view % 3 - 3, 0}, 1, seed));
    seen = jumping;
    EXPECT_GT(uncertain.correct(seen).num_views, 0);
    EXPECT_EQ(seen.frame.color, jumping.frame.color);
    seen = jumping;
    EXPECT_EQ(off.correct(seen).num_views, 0);
    EXPECT_EQ(seen.frame.color, jumping.frame.color);
  }
}

TEST(ColorOffsetCorrector, RefusesNonsense) {
  EXPECT_THROW(ColorOffsetCorrector({.correct = true, .min_views = 0}), std::invalid_argument);
  EXPECT_THROW(ColorOffsetCorrector({.correct = true, .max_spread_px = -1}), std::invalid_argument);
}

}  // namespace
}  // namespace resight
