// SPDX-License-Identifier: Apache-2.0
#include "terminal.hpp"

#include <cstdio>

namespace resight::app {

namespace {

void print_lines_of(std::string_view text, std::string (*make_printable)(std::string_view)) {
  while (!text.empty()) {
    const std::size_t end = text.find('\n');
    const std::string line = make_printable(text.substr(0, end));
    std::fwrite(line.data(), 1, line.size(), stdout);
    if (end == text.npos) return;
    std::fputc('\n', stdout);
    text.remove_prefix(end + 1);
  }
}

}  // namespace

void print_text(std::string_view text) { print_lines_of(text, printable); }
void print_json(std::string_view json) { print_lines_of(json, printable_json); }

bool finish_output() { return std::fflush(stdout) == 0 && std::ferror(stdout) == 0; }

void print_error_line(std::string_view kind, std::string_view what) {
  // Files may have keys and names of any length.
  constexpr std::size_t kMaxBytes = 2000;
  std::string shown = printable(what.substr(0, kMaxBytes));
  if (what.size() > kMaxBytes) shown += " ...";
  std::fprintf(stderr, "resight: %s%s\n", printable(kind).c_str(), shown.c_str());
}

}  // namespace resight::app
