// SPDX-License-Identifier: Apache-2.0
#include "resight/io/toml_keys.hpp"

#include <fmt/format.h>

namespace resight {

Result<void> check_toml_keys(std::string_view text) {
  constexpr int kMaxDots = 100;
  constexpr std::string_view kEndsOfKeys = ",[]{}=/\n";
  int line = 1;
  int num_dots = 0;
  char previous = 0;
  for (const char c : text) {
    if (c == '\n') ++line;
    if (kEndsOfKeys.find(c) != kEndsOfKeys.npos) num_dots = 0;
    // A row of dots, as in a comment, is no key.
    if (c == '.' && previous != '.' && ++num_dots > kMaxDots)
      return Error{fmt::format("line {}: a key has more than {} parts", line, kMaxDots)};
    previous = c;
  }
  return {};
}

}  // namespace resight
