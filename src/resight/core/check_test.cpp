// SPDX-License-Identifier: Apache-2.0
#include "resight/core/check.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <limits>
#include <stdexcept>

namespace resight {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInf = std::numeric_limits<double>::infinity();

TEST(Check, RequireThrowsItsMessage) {
  EXPECT_NO_THROW(require(true, "never"));
  EXPECT_THAT([] { require(false, "two clouds needed"); },
              testing::ThrowsMessage<std::invalid_argument>("two clouds needed"));
}

TEST(Check, NamesFieldValueAndRule) {
  EXPECT_THAT([] { check_positive("voxel_m", -0.5); },
              testing::ThrowsMessage<std::invalid_argument>("voxel_m = -0.5 (must be > 0)"));
  EXPECT_THAT([] { check_not_negative("margin", -1); },
              testing::ThrowsMessage<std::invalid_argument>("margin = -1 (must be >= 0)"));
  EXPECT_THAT([] { check_in_range("share", 1.5, 0, 1); },
              testing::ThrowsMessage<std::invalid_argument>("share = 1.5 (must be in [0, 1])"));
}

TEST(Check, BordersOfTheRules) {
  EXPECT_THROW(check_positive("x", 0), std::invalid_argument);
  EXPECT_NO_THROW(check_positive("x", std::numeric_limits<double>::min()));
  EXPECT_NO_THROW(check_not_negative("x", 0));
  EXPECT_NO_THROW(check_in_range("x", 0, 0, 1));
  EXPECT_NO_THROW(check_in_range("x", 1, 0, 1));
  EXPECT_THROW(check_in_range("x", std::nextafter(1.0, 2.0), 0, 1), std::invalid_argument);
  EXPECT_THROW(check_in_range("x", kInf, 0, 1), std::invalid_argument);
}

TEST(Check, NanFailsEveryRule) {
  EXPECT_THROW(check_positive("x", kNan), std::invalid_argument);
  EXPECT_THROW(check_not_negative("x", kNan), std::invalid_argument);
  EXPECT_THROW(check_in_range("x", kNan, -kInf, kInf), std::invalid_argument);
}

}  // namespace
}  // namespace resight
