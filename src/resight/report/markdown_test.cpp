// SPDX-License-Identifier: Apache-2.0
#include "resight/report/internal/markdown.hpp"

#include <gtest/gtest.h>

namespace resight::report {
namespace {

TEST(Markdown, NamesArePlainText) {
  for (const char* name : {"obj_000001", "mug (red)", "Gläser", "a-b.c+d"}) EXPECT_EQ(escape_markdown(name), name);
  EXPECT_EQ(escape_markdown("a | b"), "a &#124; b");
  EXPECT_EQ(escape_markdown("<img src=x>"), "\\<img src=x\\>");
  EXPECT_EQ(escape_markdown("[x](http://y)"), "\\[x\\](http://y)");
  EXPECT_EQ(escape_markdown("a\n# b"), "a\\\\x0a\\# b");
}

}  // namespace
}  // namespace resight::report
