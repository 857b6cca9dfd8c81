// SPDX-License-Identifier: Apache-2.0
#include "resight/core/image.hpp"

#include <gtest/gtest.h>

#include <numeric>

namespace resight {
namespace {

TEST(Image, StartsEmpty) {
  const Image<int> image;
  EXPECT_TRUE(image.empty());
  EXPECT_EQ(image.width(), 0);
  EXPECT_FALSE(image.contains(0, 0));
}

TEST(Image, IsRowMajorColumnFirst) {
  std::vector<int> data(12);
  std::iota(data.begin(), data.end(), 0);
  Image<int> image(4, 3, data);
  EXPECT_EQ(image(1, 0), 1);
  EXPECT_EQ(image(0, 1), 4);
  EXPECT_EQ(image(3, 2), 11);
  EXPECT_EQ(image.index(3, 2), 11U);
  EXPECT_EQ(image.row(1).size(), 4U);
  EXPECT_EQ(image.row(1)[2], 6);
  image(2, 1) = 60;
  image.row(0)[3] = 30;
  EXPECT_EQ(image[6], 60);
  EXPECT_EQ(std::as_const(image).row(0)[3], 30);
  EXPECT_EQ(image.data().size(), image.size());
}

TEST(Image, FillsAndCompares) {
  const Image<Rgb8> red(2, 3, Rgb8{255, 0, 0});
  EXPECT_EQ(red, Image<Rgb8>(2, 3, Rgb8{255, 0, 0}));
  EXPECT_NE(red, Image<Rgb8>(3, 2, Rgb8{255, 0, 0}));
  EXPECT_NE(red, Image<Rgb8>(2, 3));
}

TEST(Image, ContainsExactlyItsPixels) {
  const Image<int> image(3, 2);
  int inside = 0;
  for (int v = -2; v < 5; ++v)
    for (int u = -2; u < 6; ++u) inside += image.contains(u, v) ? 1 : 0;
  EXPECT_EQ(inside, 6);
  EXPECT_TRUE(image.contains(2, 1));
  EXPECT_FALSE(image.contains(3, 1));
}

}  // namespace
}  // namespace resight
