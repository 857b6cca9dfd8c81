// SPDX-License-Identifier: Apache-2.0
#include "line_file.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>

#include "commands.hpp"
#include "resight/core/files.hpp"

namespace resight::app {
namespace {

[[noreturn]] void fail_to_write(const std::filesystem::path& file, int code) {
  throw InputError(file_error(file, "cannot be written (" + std::generic_category().message(code) + ")").message);
}

}  // namespace

void LineFile::add(const std::string& line) {
  const std::string bytes = line + "\n";
  errno = 0;
  if (!out_.is_open()) {
    value_or_throw(write_file(file_, bytes));
    out_.open(file_, std::ios::binary | std::ios::app);
  } else {
    out_ << bytes << std::flush;
  }
  if (!out_) fail_to_write(file_, errno != 0 ? errno : EIO);
}

void LineFile::sync() {
  if (!out_.is_open()) return;
  // std::ofstream hides its descriptor, and fsync() takes any descriptor of the file.
  const int descriptor = ::open(file_.c_str(), O_RDONLY | O_CLOEXEC);
  if (descriptor < 0) fail_to_write(file_, errno);
  const int code = sync_file(descriptor);
  ::close(descriptor);
  if (code != 0) fail_to_write(file_, code);
}

void LineFile::remove() {
  out_.close();
  std::error_code ignored;
  std::filesystem::remove(file_, ignored);
}

}  // namespace resight::app
