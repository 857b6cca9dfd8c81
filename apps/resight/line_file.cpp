// SPDX-License-Identifier: Apache-2.0
#include "line_file.hpp"

#include <cerrno>
#include <system_error>

#include "commands.hpp"
#include "resight/core/files.hpp"

namespace resight::app {

void LineFile::add(const std::string& line) {
  const std::string bytes = line + "\n";
  errno = 0;
  if (!out_.is_open()) {
    value_or_throw(write_file(file_, bytes));
    out_.open(file_, std::ios::binary | std::ios::app);
  } else {
    out_ << bytes << std::flush;
  }
  if (!out_)
    throw InputError(
        file_error(file_, "cannot be written (" + std::generic_category().message(errno != 0 ? errno : EIO) + ")")
            .message);
}

void LineFile::remove() {
  out_.close();
  std::error_code ignored;
  std::filesystem::remove(file_, ignored);
}

}  // namespace resight::app
