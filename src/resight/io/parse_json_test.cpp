// SPDX-License-Identifier: Apache-2.0
#include "resight/io/parse_json.hpp"

#include <string>
#include <tuple>

#include "resight/io/internal/test_data.hpp"

namespace resight {
namespace {

std::string list_of(std::string_view value, std::size_t num_values) {
  std::string text = "[";
  for (std::size_t i = 0; i < num_values; ++i) text.append(i == 0 ? "" : ",").append(value);
  return text + "]";
}

TEST(ParseJson, LongListsOfObjectsTakeTimeInProportion) {
  // The parser with a callback took hours.
  constexpr std::size_t kNumObjects = 1000000;
  const auto json = parse_json(list_of("{}", kNumObjects));
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

TEST(ParseJson, ValuesThatWouldTakeTooMuchMemoryAreNotBuilt) {
  constexpr std::size_t kNumValues = 1000;
  const std::string long_text = '"' + std::string(100, 'x') + '"';
  // What one value takes at least, and for sure not.
  const std::tuple<std::string, std::size_t, std::size_t> kinds[] = {
      {"0", 16, 48}, {"[]", 40, 120}, {"{}", 64, 160}, {R"({"a":0})", 160, 320}, {long_text, 148, 240}};
  for (const auto& [value, least_bytes, most_bytes] : kinds) {
    const std::string text = list_of(value, kNumValues);
    EXPECT_FALSE(parse_json(text, least_bytes * kNumValues).ok()) << value;
    EXPECT_TRUE(parse_json(text, most_bytes * kNumValues).ok()) << value;
  }
  const std::string bomb = list_of("{}", 4000000);
  const io::MemoryGrowth growth;
  EXPECT_EQ(parse_json(bomb, std::size_t{16} << 20).error().message, "has more values than fit into 16 MB of memory");
  EXPECT_LT(growth.bytes(), 50'000'000U);
}

}  // namespace
}  // namespace resight
