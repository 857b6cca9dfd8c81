// SPDX-License-Identifier: Apache-2.0
#include "resight/core/printable.hpp"

#include <gtest/gtest.h>

#include "resight/core/names.hpp"

namespace resight {
namespace {

TEST(Printable, TextForPeopleStays) {
  for (const char* text : {"", "mug", "Gläser & Töpfe <2>", "コップ", "a\\b \"c\" 'd'", "\xF0\x9F\x8D\xB5"})
    EXPECT_EQ(printable(text), text);
}

TEST(Printable, WhatControlsATerminalIsEscaped) {
  EXPECT_EQ(printable("a\x1b[31mb"), "a\\x1b[31mb");
  EXPECT_EQ(printable("a\nresight: done\r\t\x7f"), "a\\x0aresight: done\\x0d\\x09\\x7f");
  EXPECT_EQ(printable("\xC2\x9B"
                      "2J"),
            "\\xc2\\x9b2J")
      << "C1: the 8-bit form of ESC [";
  EXPECT_EQ(printable("\xE2\x80\xAE"
                      "x"),
            "\\xe2\\x80\\xaex")
      << "writes from right to left";
  EXPECT_EQ(printable(std::string_view("a\0b", 3)), "a\\x00b");
}

TEST(Printable, BytesThatAreNotUtf8AreEscaped) {
  EXPECT_EQ(printable("\x9B"
                      "2J"),
            "\\x9b2J");
  EXPECT_EQ(printable("\xC0\x9B"), "\\xc0\\x9b") << "an overlong encoding of ESC [";
  EXPECT_EQ(printable("\xE2\x80"), "\\xe2\\x80") << "cut off";
  EXPECT_EQ(printable("\xED\xA0\x80"), "\\xed\\xa0\\x80") << "half a surrogate pair";
}

TEST(Printable, JsonStaysJson) {
  EXPECT_EQ(printable_json(R"({"a": "x\u001b\"y", "b": [1, 2]})"), R"({"a": "x\u001b\"y", "b": [1, 2]})");
  EXPECT_EQ(printable_json("\"x\xE2\x80\xAE\x7F\xC2\x9B\""), R"("x\u202e\u007f\u009b")");
  EXPECT_EQ(printable_json("\"a\xFF\""), R"("a\ufffd")");
}

TEST(ObjectNames, NamesArePartsOfLinesAndPaths) {
  for (const char* name : {"mug", "obj_000001", "Tasse (grün) #2", "a.b", "..."})
    EXPECT_TRUE(check_object_name(name).ok()) << name;
  for (const char* name : {"", ".", "..", "../../x", "a/b", "a\\b", "a\nb", "\x1b[2J"})
    EXPECT_FALSE(check_object_name(name).ok()) << name;
  EXPECT_TRUE(check_object_name(std::string(200, 'a')).ok());
  EXPECT_FALSE(check_object_name(std::string(201, 'a')).ok());
  EXPECT_EQ(check_object_name("a\nb").error().message.find('\n'), std::string::npos);
}

}  // namespace
}  // namespace resight
