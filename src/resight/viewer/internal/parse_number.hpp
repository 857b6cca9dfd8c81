// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <charconv>
#include <optional>
#include <string_view>

namespace resight::viewer {

/// A number below `count`, of digits only.
inline std::optional<int> parse_number_below(std::string_view text, int count) {
  int number = -1;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (text.empty() || text.size() > 9 || end != text.data() + text.size() || error != std::errc()) return std::nullopt;
  return number >= 0 && number < count ? std::optional(number) : std::nullopt;
}

}  // namespace resight::viewer
