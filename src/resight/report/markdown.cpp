// SPDX-License-Identifier: Apache-2.0
#include "resight/report/internal/markdown.hpp"

#include "resight/core/printable.hpp"

namespace resight::report {

std::string escape_markdown(std::string_view name) {
  constexpr std::string_view kSpecial = "\\`*[]<>&~#!";
  std::string text;
  for (const char c : printable(name)) {
    if (c == '|') {
      text += "&#124;";  // Some readers of tables do not know the backslash.
      continue;
    }
    if (kSpecial.find(c) != kSpecial.npos) text += '\\';
    text += c;
  }
  return text;
}

}  // namespace resight::report
