// SPDX-License-Identifier: Apache-2.0
#include "resight/io/toml_keys.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string>

namespace resight {
namespace {

/// Where the text in quotes ends that begins at `begin`.
std::size_t end_of_quoted(std::string_view text, std::size_t begin) {
  const char quote = text[begin];
  std::string closing(3, quote);
  const bool is_multiline = text.substr(begin).starts_with(closing);
  if (!is_multiline) closing.resize(1);
  std::size_t i = begin + closing.size();
  while (i < text.size() && !text.substr(i).starts_with(closing)) {
    if (!is_multiline && text[i] == '\n') return i;  // has no end: an error of the parser
    i += quote == '"' && text[i] == '\\' ? 2 : 1;
  }
  i += closing.size();
  // Up to two quotes before the closing three belong to the text.
  for (int k = 0; k < 2 && is_multiline && i < text.size() && text[i] == quote; ++k) ++i;
  return std::min(i, text.size());
}

}  // namespace

Result<void> check_toml_keys(std::string_view text) {
  constexpr int kMaxDots = 100;
  constexpr std::string_view kEndsOfKeys = ",[]{}=\n";
  std::ptrdiff_t line = 1;
  int num_dots = 0;
  std::size_t end = 0;
  for (std::size_t begin = 0; begin < text.size(); begin = end) {
    const char c = text[begin];
    end = begin + 1;
    if (c == '"' || c == '\'') end = end_of_quoted(text, begin);
    if (c == '#') end = std::min(text.find('\n', begin), text.size());
    if (kEndsOfKeys.find(c) != kEndsOfKeys.npos) num_dots = 0;
    if (c == '.' && ++num_dots > kMaxDots)
      return Error{fmt::format("line {}: a key has more than {} parts", line, kMaxDots)};
    line += std::ranges::count(text.substr(begin, end - begin), '\n');
  }
  return {};
}

}  // namespace resight
