// SPDX-License-Identifier: Apache-2.0
#include "resight/io/internal/json.hpp"

#include <gmock/gmock.h>

#include <string>

namespace resight::io {
namespace {

TEST(ParseJson, LongListsOfObjectsTakeTimeInProportion) {
  // The parser with a callback took hours.
  constexpr std::size_t kNumObjects = 1000000;
  std::string text = "[{}";
  text.reserve(4 * kNumObjects);
  for (std::size_t i = 1; i < kNumObjects; ++i) text += ",{}";
  const auto json = parse_json(text + "]");
  ASSERT_TRUE(json.ok());
  EXPECT_EQ(json->size(), kNumObjects);
}

TEST(ParseJson, FaultsAreNamed) {
  const auto message_of = [](const std::string& text) { return parse_json(text).error().message; };
  EXPECT_TRUE(parse_json(R"({"a":{"a":[1,{"a":2}]},"b":null})").ok());
  EXPECT_EQ(message_of(R"([{"a":1,"b":{"a":1},"a":2}])"), "has the key 'a' twice in one object");
  EXPECT_EQ(message_of("[1,\n2"), "is not valid JSON: line 2 (cut off?)");
  EXPECT_EQ(message_of("[1e999]"), "is not valid JSON: a number is too large");
  EXPECT_EQ(message_of(std::string(1000000, '[')), "is nested more than 64 deep");
  EXPECT_TRUE(parse_json(std::string(64, '[') + std::string(64, ']')).ok());
}

}  // namespace
}  // namespace resight::io
