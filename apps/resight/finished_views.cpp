// SPDX-License-Identifier: Apache-2.0
#include "finished_views.hpp"

#include "commands.hpp"
#include "resight/core/files.hpp"

namespace resight::app {

void FinishedViews::add(const std::string& line) {
  if (!out_.is_open()) {
    value_or_throw(write_file(file_, line));
    out_.open(file_, std::ios::binary | std::ios::app);
  } else {
    out_ << line << std::flush;  // A view that is finished must survive whatever comes next.
  }
  if (!out_) throw InputError(file_error(file_, "cannot be written").message);
}

void FinishedViews::remove() {
  out_.close();
  std::error_code ignored;
  std::filesystem::remove(file_, ignored);
}

}  // namespace resight::app
