// SPDX-License-Identifier: Apache-2.0
#include "resight/recordings/internal/random_access_file.hpp"

#include <fmt/format.h>

#include "resight/core/files.hpp"

namespace resight::recordings {

Result<RandomAccessFile> RandomAccessFile::open(const std::filesystem::path& file) {
  auto input = InputFile::open(file);
  if (!input) return input.error();
  return RandomAccessFile(file, std::move(*input));
}

Result<std::string> RandomAccessFile::read(std::uint64_t offset, std::uint64_t count) const {
  if (offset > size() || count > size() - offset)
    return file_error(file_,
                      fmt::format("ends at byte {}, within {} bytes declared at {} (cut off?)", size(), count, offset));
  std::string bytes(count, '\0');
  if (const auto done = input_.read_at(offset, bytes.data(), bytes.size()); !done) return done.error();
  return bytes;
}

}  // namespace resight::recordings
