// SPDX-License-Identifier: Apache-2.0
#include "resight/appearance/lab_color.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace resight {
namespace {

struct Known {
  Rgb8 rgb;
  double l, a, b;  // CIELAB (D65, 2 degrees), unscaled
};

TEST(ToGrey, KeepsGreysAndIsTheLumaOfColours) {
  for (const int level : {0, 1, 128, 255}) {
    const auto c = static_cast<std::uint8_t>(level);
    EXPECT_EQ(to_grey({c, c, c}), (Rgb8{c, c, c}));
  }
  EXPECT_EQ(to_grey({255, 0, 0}), (Rgb8{76, 76, 76}));
  EXPECT_EQ(to_grey({0, 255, 0}), (Rgb8{150, 150, 150}));
  EXPECT_EQ(to_grey({0, 0, 255}), (Rgb8{29, 29, 29}));
}

TEST(ToLab, AgreesWithPublishedValues) {
  const std::vector<Known> known = {{{0, 0, 0}, 0, 0, 0},
                                    {{255, 255, 255}, 100, 0, 0},
                                    {{255, 0, 0}, 53.24, 80.09, 67.20},
                                    {{0, 255, 0}, 87.73, -86.18, 83.18},
                                    {{0, 0, 255}, 32.30, 79.19, -107.86},
                                    {{119, 119, 119}, 50.03, 0, 0},
                                    {{10, 10, 10}, 2.74, 0, 0},
                                    {{255, 255, 0}, 97.14, -21.55, 94.48}};
  for (const Known& k : known) {
    const LabColor lab = to_lab(k.rgb);
    EXPECT_NEAR(50 * lab.l + 50, k.l, 0.05);
    EXPECT_NEAR(128 * lab.a, k.a, 0.1);
    EXPECT_NEAR(128 * lab.b, k.b, 0.1);
  }
}

}  // namespace
}  // namespace resight
