// SPDX-License-Identifier: Apache-2.0
#include "resight/core/srgb.hpp"

#include <gtest/gtest.h>

namespace resight {
namespace {

TEST(Srgb, TheCurveAndItsInverse) {
  EXPECT_NEAR(encode_srgb(0.1F), 89, 0.1);  // 1.055 * 0.1^(1/2.4) - 0.055 = 0.349
  EXPECT_FLOAT_EQ(encode_srgb(2), 255);
  EXPECT_FLOAT_EQ(encode_srgb(-1), 0);
  for (int i = 0; i < 256; ++i) EXPECT_NEAR(encode_srgb(decode_srgb(static_cast<float>(i))), i, 1e-2);
}

}  // namespace
}  // namespace resight
