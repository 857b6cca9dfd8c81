// SPDX-License-Identifier: Apache-2.0
#include "resight/core/json_integer.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

namespace resight {
namespace {

TEST(JsonInteger, IsAWholeNumberWithinTheRange) {
  const auto parse = [](const char* text) { return json_integer(nlohmann::json::parse(text), -5, 100); };
  EXPECT_EQ(parse("100"), 100);
  EXPECT_EQ(parse("-5"), -5);
  EXPECT_EQ(parse("-0"), 0);
  for (const char* text : {"101", "-6", "0.5", "5.0", "1e40", "-2.2e32", "18446744073709551615", "-9223372036854775808",
                           "99999999999999999999", "true", "null", "\"5\"", "[5]", "{}"})
    EXPECT_EQ(parse(text), std::nullopt) << text;
}

TEST(JsonInteger, RangesMayBeThoseOfTheType) {
  using Limits = std::numeric_limits<std::int64_t>;
  const auto parse = [](const char* text) {
    return json_integer(nlohmann::ordered_json::parse(text), Limits::min(), Limits::max());
  };
  EXPECT_EQ(parse("9223372036854775807"), Limits::max());
  EXPECT_EQ(parse("-9223372036854775808"), Limits::min());
  EXPECT_EQ(parse("9223372036854775808"), std::nullopt);
}

}  // namespace
}  // namespace resight
