// SPDX-License-Identifier: Apache-2.0
#include "resight/core/crc32.hpp"

#include <gtest/gtest.h>

namespace resight {
namespace {

TEST(Crc32, PublishedCheckValue) {
  EXPECT_EQ(compute_crc32("123456789"), 0xCBF43926U);
  EXPECT_EQ(compute_crc32(""), 0U);
}

}  // namespace
}  // namespace resight
