// SPDX-License-Identifier: Apache-2.0
#include "resight/recognition/explained_pixels.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "resight/models/testing/square_world.hpp"

namespace resight {
namespace {

using test::kLeft;
using test::kRight;
using test::make_plate;
using test::plate_at;
using test::see_nothing;
using test::see_plates;

class FindExplainedPixels : public ::testing::Test {
 protected:
  FindExplainedPixels() { library_.objects = {make_plate("a")}; }
  [[nodiscard]] static std::ptrdiff_t count(const Image<std::uint8_t>& mask) {
    return std::ranges::count(mask.data(), 255);
  }
  ModelLibrary library_;
};

TEST_F(FindExplainedPixels, AreThoseOfAnObjectAtItsPlace) {
  const RgbdFrame frame = see_plates({kLeft, kRight});
  const Image<std::uint8_t> mask = find_explained_pixels(frame, std::vector<TrackedObject>{{0, 0, kLeft, 0}}, library_);
  ASSERT_EQ(mask.width(), frame.camera.width);
  for (int v = 0; v < mask.height(); ++v)
    for (int u = 0; u < mask.width(); ++u)
      EXPECT_EQ(mask(u, v) != 0, frame.depth_m(u, v) < 1.5F && u < mask.width() / 2) << u << " " << v;
}

TEST_F(FindExplainedPixels, AnObjectThatHasLeftOrIsNotSeenExplainsNothing) {
  const std::vector<TrackedObject> known{{0, 0, kLeft, 0}};
  EXPECT_EQ(count(find_explained_pixels(see_plates({kRight}), known, library_)), 0);
  EXPECT_EQ(count(find_explained_pixels(see_nothing(), known, library_)), 0);
  EXPECT_EQ(count(find_explained_pixels(see_plates({kLeft}), {}, library_)), 0);
  // A fifth of it is free: it has been shifted.
  EXPECT_EQ(count(find_explained_pixels(see_plates({plate_at(-0.26, 0, 1)}), known, library_)), 0);
}

TEST_F(FindExplainedPixels, AnObjectInFrontIsNotExplained) {
  const Rigid3 before = plate_at(-0.16, 0, 0.8);
  const RgbdFrame frame = see_plates({kLeft, before});
  const Image<std::uint8_t> mask = find_explained_pixels(frame, std::vector<TrackedObject>{{0, 0, kLeft, 0}}, library_);
  EXPECT_GT(count(mask), 0);
  for (int v = 0; v < mask.height(); ++v)
    for (int u = 0; u < mask.width(); ++u) EXPECT_FALSE(frame.depth_m(u, v) < 0.9F && mask(u, v) != 0) << u << " " << v;
}

}  // namespace
}  // namespace resight
