// SPDX-License-Identifier: Apache-2.0
#include "resight/report/internal/files.hpp"

#include <unistd.h>

#include <fstream>
#include <string>
#include <system_error>

namespace resight::report {
namespace fs = std::filesystem;

Result<void> write_whole_file(const fs::path& path, std::string_view bytes) {
  std::error_code failure;
  if (path.has_parent_path()) fs::create_directories(path.parent_path(), failure);
  if (failure) return Error{path.parent_path().string() + ": cannot make this folder: " + failure.message()};
  fs::path pending = path;
  pending += ".tmp" + std::to_string(::getpid());  // another process may write the same file
  {
    std::ofstream out(pending, std::ios::binary | std::ios::trunc);
    out.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    out.close();
    if (!out) {
      fs::remove(pending, failure);
      return Error{path.string() + ": cannot be written (is the folder writable and the disk not full?)"};
    }
  }
  fs::rename(pending, path, failure);
  if (!failure) return {};
  const std::string reason = failure.message();
  fs::remove(pending, failure);
  return Error{path.string() + ": cannot be written: " + reason};
}

}  // namespace resight::report
