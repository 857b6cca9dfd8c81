// SPDX-License-Identifier: Apache-2.0
#include "resight/sensor/color_offset.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "resight/core/random.hpp"
#include "resight/sensor/testing/enlarge_frame.hpp"

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

TEST(MeasureColorOffset, ReachesFartherInLargeImages) {
  const auto measured = measure_color_offset(prepare_view(test::enlarge(see_boards({-2, 1}))));
  ASSERT_TRUE(measured.has_value());
  EXPECT_LT((*measured - Eigen::Vector2d(-8, 4)).norm(), 0.6) << measured->transpose();
}

TEST(ColorOffsetEstimator, CorrectsLargeImages) {
  ColorOffsetEstimator estimator({.correct = true});
  for (std::uint64_t view = 0; view < 3; ++view)
    estimator.add(prepare_view(test::enlarge(see_boards({-2, 1}, 0, view))));
  const ColorOffset raw = estimator.offset();
  EXPECT_LT((raw.corrected_px() - Eigen::Vector2d(-8, 4)).norm(), 0.6) << raw.offset_px.transpose();
  ColorOffsetEstimator again({.correct = true});
  for (std::uint64_t view = 0; view < 3; ++view) {
    RgbdFrame frame = test::enlarge(see_boards({-2, 1}, 0, view));
    correct_color_offset(raw, frame);
    again.add(prepare_view(frame), raw);
  }
  EXPECT_LT((again.offset().offset_px - raw.offset_px).norm(), 0.05);
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

ColorOffset estimate(const std::vector<Eigen::Vector2i>& offsets_px, const ColorOffset& corrected = {}) {
  ColorOffsetEstimator estimator({.correct = true});
  std::uint64_t seed = 0;
  for (const Eigen::Vector2i& offset_px : offsets_px) {
    RgbdFrame frame = see_boards(offset_px, 1, ++seed);
    correct_color_offset(corrected, frame);
    estimator.add(prepare_view(frame), corrected);
  }
  return estimator.offset();
}

TEST(ColorOffsetEstimator, IsSureFromThreeViewsOn) {
  EXPECT_TRUE(estimate({{2, -1}, {2, -1}}).corrected_px().isZero());
  const ColorOffset offset = estimate({{2, -1}, {2, -1}, {2, -1}});
  EXPECT_EQ(offset.num_views, 3);
  EXPECT_LT((offset.offset_px - Eigen::Vector2d(2, -1)).norm(), 0.2);
  EXPECT_LT(offset.sigma_px.maxCoeff(), 0.3);
  EXPECT_EQ(offset.corrected_px(), offset.offset_px);
  EXPECT_EQ(offset.moved_px(), Eigen::Vector2i(2, -1));
}

TEST(ColorOffsetEstimator, CorrectedViewsShowTheSameOffset) {
  const std::vector<Eigen::Vector2i> views(4, {2, -1});
  const ColorOffset raw = estimate(views);
  EXPECT_LT((estimate(views, raw).offset_px - raw.offset_px).norm(), 1e-6);
}

TEST(ColorOffsetEstimator, CorrectsNothingThatIsRightOrUncertain) {
  EXPECT_TRUE(estimate({{0, 0}, {0, 0}, {0, 0}, {0, 0}}).corrected_px().isZero());
  const ColorOffset jumping = estimate({{-3, 0}, {3, 0}, {-3, 0}, {3, 0}});
  EXPECT_GT(jumping.sigma_px.x(), 1) << "the views contradict each other";
  EXPECT_TRUE(jumping.corrected_px().isZero());
  const ColorOffset unknown = estimate({{9, 0}, {9, 0}, {9, 0}});
  EXPECT_TRUE(std::isinf(unknown.sigma_px.x())) << "beyond the reach of the search";
  EXPECT_TRUE(unknown.corrected_px().isZero());
  ColorOffsetEstimator off;
  for (int view = 0; view < 3; ++view) off.add(prepare_view(see_boards({2, -1})));
  EXPECT_EQ(off.offset().num_views, 0);
}

TEST(ColorOffsetEstimator, MostViewsSayOfWhichCameraItIs) {
  const auto see_with = [](double f_px, Eigen::Vector2i offset_px, std::uint64_t seed) {
    RgbdFrame frame = see_boards(offset_px, 1, seed);
    frame.camera.fx = frame.camera.fy = f_px;
    return frame;
  };
  ColorOffsetEstimator estimator({.correct = true});
  for (std::uint64_t view = 0; view < 8; ++view)  // The focus of one of the cameras breathes.
    estimator.add(prepare_view(view % 3 == 0 ? see_with(560, {-3, 1}, view)
                                             : see_with(280 + static_cast<double>(view), {2, -1}, view)));
  const ColorOffset offset = estimator.offset();
  EXPECT_EQ(offset.num_views, 5);
  EXPECT_LT((offset.corrected_px() - Eigen::Vector2d(2, -1)).norm(), 0.2) << offset.offset_px.transpose();
  RgbdFrame other = see_with(560, {-3, 1}, 9);
  correct_color_offset(offset, other);
  EXPECT_EQ(other.color, see_with(560, {-3, 1}, 9).color);
  EXPECT_EQ(other.camera.cx, kOffsetCamera.cx);
  for (int view = 0; view < 4; ++view) estimator.add(prepare_view(other), offset);
  EXPECT_EQ(estimator.offset().num_views, 7);
  EXPECT_LT((estimator.offset().corrected_px() - Eigen::Vector2d(-3, 1)).norm(), 0.2);
}

TEST(CorrectColorOffset, PutsTheDepthOnTheRaysOfItsColors) {
  const RgbdFrame beside = see_boards({2, -1});
  RgbdFrame corrected = beside;
  correct_color_offset({.offset_px = {2.2, -0.9}, .sigma_px = {0.2, 0.2}, .num_views = 3, .camera = kOffsetCamera},
                       corrected);
  EXPECT_EQ(corrected.depth_m, beside.depth_m);
  EXPECT_EQ(corrected.color(31, 60), beside.color(33, 59));
  const Eigen::Vector3d point = corrected.camera.unproject(31, 60, 1.0);
  EXPECT_LT((beside.camera.project(point) - Eigen::Vector2d(33.2, 59.1)).norm(), 1e-9);
  RgbdFrame uncertain = beside;
  correct_color_offset({.offset_px = {0.3, -0.9}, .sigma_px = {0.2, 0.2}, .num_views = 3, .camera = kOffsetCamera},
                       uncertain);
  EXPECT_EQ(uncertain.camera.cx, beside.camera.cx);
  EXPECT_EQ(uncertain.camera.cy, beside.camera.cy + 0.9);
}

}  // namespace
}  // namespace resight
