// SPDX-License-Identifier: Apache-2.0
#include "progress.hpp"

#include <unistd.h>

#include <cstdio>

#include "resight/core/printable.hpp"

namespace resight::app {

Progress::Progress(const std::string& what, int num_items)
    : what_(printable(what)), num_items_(num_items), is_terminal_(isatty(STDERR_FILENO) != 0) {}

Progress::~Progress() {
  if (has_open_line_) std::fputc('\n', stderr);
}

void Progress::report(int done, const std::string& detail) {
  const std::string of_all = num_items_ > 0 ? "/" + std::to_string(num_items_) : "";
  // ESC[K clears the rest of a longer previous line.
  std::fprintf(stderr, is_terminal_ ? "\r%s %d%s: %s\x1b[K" : "%s %d%s: %s\n", what_.c_str(), done, of_all.c_str(),
               printable(detail).c_str());
  std::fflush(stderr);
  has_open_line_ = is_terminal_;
}

}  // namespace resight::app
