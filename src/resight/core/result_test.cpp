// SPDX-License-Identifier: Apache-2.0
#include "resight/core/result.hpp"

#include <gmock/gmock.h>

#include <memory>

namespace resight {
namespace {

Result<int> parse_digit(char c) {
  if (c < '0' || c > '9') return Error{"'x': not a digit"};
  return c - '0';
}

TEST(Result, HoldsAValue) {
  const Result<int> result = parse_digit('7');
  ASSERT_TRUE(result.ok());
  EXPECT_TRUE(static_cast<bool>(result));
  EXPECT_EQ(result.value(), 7);
  EXPECT_EQ(*result, 7);
}

TEST(Result, HoldsAnError) {
  const Result<int> result = parse_digit('x');
  ASSERT_FALSE(result.ok());
  EXPECT_FALSE(static_cast<bool>(result));
  EXPECT_EQ(result.error().message, "'x': not a digit");
}

TEST(Result, ThrowsTheErrorWhenTheValueIsMissing) {
  Result<int> result = parse_digit('x');
  EXPECT_THAT([&] { (void)result.value(); },
              testing::ThrowsMessage<std::logic_error>(testing::HasSubstr("'x': not a digit")));
  EXPECT_THROW((void)std::as_const(result).value(), std::logic_error);
  EXPECT_THROW((void)*result, std::logic_error);
  EXPECT_THROW((void)parse_digit('x').value(), std::logic_error);
}

TEST(Result, PassesOnWhatCannotBeCopied) {
  Result<std::unique_ptr<int>> result(std::make_unique<int>(5));
  std::unique_ptr<int> taken = *std::move(result);
  ASSERT_NE(taken, nullptr);
  EXPECT_EQ(*taken, 5);
}

TEST(Result, GivesWriteAccess) {
  Result<std::string> result(std::string("a"));
  *result += "b";
  result->append("c");
  EXPECT_EQ(result.value(), "abc");
}

TEST(ResultVoid, IsSuccessOrError) {
  EXPECT_TRUE(Result<void>().ok());
  const Result<void> failed = Error{"disk full"};
  EXPECT_FALSE(failed.ok());
  EXPECT_FALSE(static_cast<bool>(failed));
  EXPECT_EQ(failed.error().message, "disk full");
}

}  // namespace
}  // namespace resight
