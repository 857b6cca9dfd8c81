// SPDX-License-Identifier: Apache-2.0
#include "resight/evidence/color_change.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <stdexcept>
#include <utility>

#include "resight/core/random.hpp"

namespace resight {
namespace {

constexpr int kWallWidth = 160;
constexpr int kWallHeight = 120;
constexpr Rgb8 kWood{190, 150, 110};
constexpr Rgb8 kPen{40, 50, 140};

/// A wall of these colours, 1 m away.
PreparedView see_colors(Image<Rgb8> colors) {
  return prepare_view({"wall", Camera{kWallWidth, kWallHeight, 140, 140, 79.5, 59.5}, std::move(colors),
                       Image<float>(kWallWidth, kWallHeight, 1), Rigid3::identity()});
}

Image<Rgb8> wood() { return Image<Rgb8>(kWallWidth, kWallHeight, kWood); }

bool is_pen(int u, int v) { return u >= 60 && u < 80 && v >= 50 && v < 53; }

Image<Rgb8> wood_with_pen() {
  Image<Rgb8> colors = wood();
  for (int v = 0; v < colors.height(); ++v)
    for (int u = 0; u < colors.width(); ++u)
      if (is_pen(u, v)) colors(u, v) = kPen;
  return colors;
}

template <typename Change>
Image<Rgb8> changed(Image<Rgb8> colors, const Change& change) {
  for (int v = 0; v < colors.height(); ++v)
    for (int u = 0; u < colors.width(); ++u) {
      const auto level = [&](int x) { return static_cast<std::uint8_t>(std::clamp(change(x, u, v), 0, 255)); };
      colors(u, v) = {level(colors(u, v).r), level(colors(u, v).g), level(colors(u, v).b)};
    }
  return colors;
}

Image<int> same_pixels() {
  Image<int> pixels(kWallWidth, kWallHeight);
  std::iota(pixels.data().begin(), pixels.data().end(), 0);
  return pixels;
}

std::vector<int> find_in(const Image<Rgb8>& colors, const Image<Rgb8>& others, int radius_px = 1,
                         const Image<int>& pixels = same_pixels()) {
  std::vector<int> all(pixels.size());
  std::iota(all.begin(), all.end(), 0);
  return find_color_changes(see_colors(colors), see_colors(others), pixels, all, radius_px).standing_out;
}

TEST(FindColorChanges, AThinThingThatComesOrGoes) {
  std::vector<int> pen;
  for (int v = 0; v < kWallHeight; ++v)
    for (int u = 0; u < kWallWidth; ++u)
      if (is_pen(u, v)) pen.push_back(v * kWallWidth + u);
  EXPECT_EQ(find_in(wood_with_pen(), wood()), pen);
  EXPECT_EQ(find_in(wood(), wood_with_pen(), 0), pen);
  EXPECT_EQ(find_in(wood(), wood()), std::vector<int>{});
}

TEST(FindColorChanges, OnlyCandidatesCount) {
  const std::vector<int> candidates{51 * kWallWidth + 70, 51 * kWallWidth + 61, 10};
  const ColorChanges found =
      find_color_changes(see_colors(wood_with_pen()), see_colors(wood()), same_pixels(), candidates, 1);
  EXPECT_EQ(found.standing_out, (std::vector<int>{candidates[0], candidates[1]}));
  EXPECT_EQ(found.same, std::vector<int>{candidates[2]});
}

TEST(FindColorChanges, TheInsideOfALargeThingDiffersButDoesNotStandOut) {
  Image<Rgb8> colors = wood();
  for (int v = 20; v < 100; ++v)
    for (int u = 40; u < 120; ++u) colors(u, v) = kPen;
  const auto pixel = [](int u, int v) { return v * kWallWidth + u; };
  const std::vector<int> candidates{pixel(40, 60), pixel(80, 60), pixel(10, 60)};
  const ColorChanges found = find_color_changes(see_colors(colors), see_colors(wood()), same_pixels(), candidates, 0);
  EXPECT_EQ(found.standing_out, std::vector<int>{candidates[0]});
  EXPECT_EQ(found.different, std::vector<int>{candidates[1]});
  EXPECT_EQ(found.same, std::vector<int>{candidates[2]});
}

TEST(FindColorChanges, BetweenHalfOfTheLimitAndTheLimitNothingIsSaid) {
  Image<Rgb8> colors = wood();  // The limit is 32 grey levels.
  const auto found_with = [&](int difference) {
    colors(70, 50).b = static_cast<std::uint8_t>(kWood.b + difference);
    return find_color_changes(see_colors(colors), see_colors(wood()), same_pixels(), std::vector{50 * kWallWidth + 70},
                              0);
  };
  EXPECT_EQ(found_with(14).same.size(), 1);
  const ColorChanges between = found_with(24);
  EXPECT_EQ(between.same.size() + between.different.size() + between.standing_out.size(), 0);
  EXPECT_EQ(found_with(40).standing_out.size(), 1);
}

TEST(FindColorChanges, ExposureAndSoftShadowsAreNone) {
  const Image<Rgb8> colors = wood_with_pen();
  EXPECT_EQ(find_in(colors, changed(colors, [](int x, int, int) { return x * 4 / 5 + 9; }), 0).size(), 0);
  EXPECT_EQ(find_in(colors, changed(colors, [](int x, int u, int) { return x * (200 - u / 2) / 200; })).size(), 0);
}

TEST(FindColorChanges, ColoursThatLieBesideEachOtherAreNone) {
  Image<Rgb8> print = wood();
  for (int v = 0; v < print.height(); ++v)
    for (int u = 0; u < print.width(); ++u)
      if ((u / 9 + v / 9) % 4 == 0) print(u, v) = kPen;
  Image<Rgb8> shifted = print;
  for (int v = 0; v < print.height(); ++v)
    for (int u = 2; u < print.width(); ++u) shifted(u, v) = print(u - 2, v);
  EXPECT_GT(find_in(print, shifted, 0).size(), 100);
  EXPECT_EQ(find_in(print, shifted, 2).size(), 0);
}

TEST(FindColorChanges, NoiseIsNone) {
  Rng rng(1);
  const auto noisy = [&](const Image<Rgb8>& colors, double sigma) {
    return changed(colors, [&](int x, int, int) { return x + static_cast<int>(sigma * rng.normal()); });
  };
  for (const double sigma : {2.0, 5.0, 10.0, 20.0})
    EXPECT_EQ(find_in(noisy(wood(), sigma), noisy(wood(), sigma)).size(), 0);
  EXPECT_EQ(find_in(noisy(wood_with_pen(), 5), noisy(wood(), 5)).size(), 3 * 20);
}

TEST(FindColorChanges, WhereTheOtherViewHasNoPixelNothingChanged) {
  Image<int> pixels = same_pixels();
  for (int v = 0; v < kWallHeight; ++v)
    for (int u = 0; u < 70; ++u) pixels(u, v) = -1;
  for (const int i : find_in(wood_with_pen(), wood(), 1, pixels)) EXPECT_GE(i % kWallWidth, 70);
  EXPECT_EQ(find_in(wood_with_pen(), wood(), 1, pixels).size(), 30);
  std::ranges::fill(pixels.data(), -1);
  EXPECT_EQ(find_in(wood_with_pen(), wood(), 1, pixels).size(), 0);
}

TEST(FindColorChanges, LookingAsBeforeMeansTheMoreTheFewerPlacesLookAlike) {
  const auto similar_share = [](const Image<Rgb8>& colors) {
    return find_color_changes(see_colors(colors), see_colors(colors), same_pixels(), {}, 1).similar_share;
  };
  EXPECT_EQ(similar_share(wood()), 1);
  EXPECT_GT(similar_share(wood_with_pen()), 0.9);
  // Each tenth of the image looks like no other.
  EXPECT_EQ(similar_share(changed(wood(), [](int, int u, int) { return 25 * (u / 16); })), 0.1);
  const Image<int> nowhere(kWallWidth, kWallHeight, -1);
  EXPECT_EQ(find_color_changes(see_colors(wood()), see_colors(wood()), nowhere, {}, 1).similar_share, 1);
}

TEST(FindColorChanges, RefusesPixelsOfAnotherView) {
  EXPECT_THROW((void)find_in(wood(), wood(), 1, Image<int>(4, 4)), std::invalid_argument);
}

}  // namespace
}  // namespace resight
