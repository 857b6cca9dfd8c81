// SPDX-License-Identifier: Apache-2.0
#include "resight/recordings/internal/random_access_file.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <utility>

#include "resight/core/files.hpp"
#include "resight/core/input_file.hpp"

namespace resight::recordings {

Result<RandomAccessFile> RandomAccessFile::open(const std::filesystem::path& file) {
  const auto checked = InputFile::open(file);  // refuses pipes and devices with the usual messages
  if (!checked) return checked.error();
  const int descriptor = ::open(file.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC);
  struct stat status {};
  if (descriptor < 0 || ::fstat(descriptor, &status) != 0 || !S_ISREG(status.st_mode)) {
    if (descriptor >= 0) ::close(descriptor);
    return file_error(file, "cannot be opened");
  }
  return RandomAccessFile(file, descriptor, static_cast<std::uint64_t>(status.st_size));
}

RandomAccessFile::RandomAccessFile(RandomAccessFile&& other) noexcept
    : file_(std::move(other.file_)), descriptor_(std::exchange(other.descriptor_, -1)), size_(other.size_) {}

RandomAccessFile::~RandomAccessFile() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

Result<std::string> RandomAccessFile::read(std::uint64_t offset, std::uint64_t count) const {
  if (offset > size_ || count > size_ - offset)
    return file_error(file_,
                      fmt::format("ends at byte {}, within {} bytes declared at {} (cut off?)", size_, count, offset));
  std::string bytes(count, '\0');
  std::uint64_t done = 0;
  while (done < count) {
    const auto size = static_cast<std::size_t>(std::min<std::uint64_t>(count - done, std::uint64_t{1} << 30));
    const ssize_t got = ::pread(descriptor_, bytes.data() + done, size, static_cast<off_t>(offset + done));
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) return file_error(file_, "cannot be read to its end");
    done += static_cast<std::uint64_t>(got);
  }
  return bytes;
}

}  // namespace resight::recordings
