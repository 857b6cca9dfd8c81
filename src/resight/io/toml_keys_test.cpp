// SPDX-License-Identifier: Apache-2.0
#include "resight/io/toml_keys.hpp"

#include <gmock/gmock.h>

#include <string>

namespace resight {
namespace {

using testing::HasSubstr;

std::string repeated(const std::string& part, int count) {
  std::string text;
  for (int i = 0; i < count; ++i) text += part;
  return text;
}

TEST(CheckTomlKeys, RefusesKeysOfVeryManyParts) {
  for (const char* part : {".a", " . a", ".\"=\"", ".'='", ".\",\"", ".\"\\\"=\"", ".'\\'", ".\"#\"", ".''", ".\"\""})
    for (const char* before : {"", "b = \"\"\"\n# it's \"new\" \\\"\"\"\"\"\"\n", "b = '''\n\"'''\n", "# it's\n",
                               "b = 'a\"'\n", "b = \"\\\"'\"\n", "b = { c = \"\"\"\nit's\"\"\", "}) {
      const auto checked = check_toml_keys(before + repeated(part, 100) + " = 1\n");
      EXPECT_TRUE(checked.ok()) << before << part << ": " << checked.error().message;
      EXPECT_FALSE(check_toml_keys(before + repeated(part, 101) + " = 1\n").ok()) << before << part;
    }
  const auto checked = check_toml_keys("b = '''\n\n'''\na" + repeated(".a", 101));
  ASSERT_FALSE(checked.ok());
  EXPECT_THAT(checked.error().message, HasSubstr("line 4: a key has more than 100 parts"));
}

TEST(CheckTomlKeys, AcceptsManyDotsElsewhere) {
  const std::string dots = repeated(" .a", 200);
  for (const std::string& text :
       {"#" + dots, "a = \"" + dots + "\"", "a = '" + dots + "'", "a = \"\"\"" + dots + "\n" + dots + "\"\"\"",
        "a = [" + repeated("0.5, ", 200) + "]", repeated("a.a = 0.5\n", 200), "a = \"" + dots, "a = \"\"\"" + dots,
        std::string("a = \"\\")})
    EXPECT_TRUE(check_toml_keys(text).ok()) << text;
}

}  // namespace
}  // namespace resight
