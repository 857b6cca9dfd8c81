// SPDX-License-Identifier: Apache-2.0
#include "resight/core/input_file.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <system_error>

#include "resight/core/files.hpp"

namespace resight {
namespace {

constexpr std::size_t kMaxBytesPerCall = std::size_t{1} << 30;

std::string describe_failure(int code) {
  if (code == ENOENT || code == ENOTDIR) return "no such file";
  return "cannot be opened (" + std::generic_category().message(code) + ")";
}

Result<std::string> read_text(InputFile& input, std::uintmax_t num_bytes) {
  std::string bytes(static_cast<std::size_t>(num_bytes), '\0');
  if (const auto done = input.read(bytes.data(), bytes.size()); !done) return done.error();
  return bytes;
}

}  // namespace

Result<InputFile> InputFile::open(const std::filesystem::path& file) {
  // O_NONBLOCK: a pipe without a writer opens at once.
  const int descriptor = ::open(file.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC);
  if (descriptor < 0) return file_error(file, errno == ENXIO ? "is not a file" : describe_failure(errno));
  InputFile input(file, descriptor, 0);
  if (const auto done = input.update_size(); !done) return done.error();
  return input;
}

Result<void> InputFile::update_size() {
  struct stat status {};
  if (::fstat(descriptor_, &status) != 0) return file_error(file_, describe_failure(errno));
  if (!S_ISREG(status.st_mode)) return file_error(file_, "is not a file");
  size_ = static_cast<std::uintmax_t>(status.st_size);
  // Files of the kernel, as in /proc, are not read as empty ones.
  char byte = 0;
  if (size_ == 0 && ::pread(descriptor_, &byte, 1, 0) != 0) return file_error(file_, "is not a file");
  return {};
}

InputFile::InputFile(InputFile&& other) noexcept
    : file_(std::move(other.file_)), descriptor_(std::exchange(other.descriptor_, -1)), size_(other.size_) {}

InputFile::~InputFile() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

Result<void> InputFile::read(void* bytes, std::size_t num_bytes) {
  auto* target = static_cast<char*>(bytes);
  while (num_bytes > 0) {
    const ssize_t count = ::read(descriptor_, target, std::min(num_bytes, kMaxBytesPerCall));
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) return file_error(file_, "cannot be read to its end");
    target += count;
    num_bytes -= static_cast<std::size_t>(count);
  }
  return {};
}

Result<void> InputFile::read_at(std::uintmax_t offset, void* bytes, std::size_t num_bytes) const {
  auto* target = static_cast<char*>(bytes);
  while (num_bytes > 0) {
    const ssize_t count =
        ::pread(descriptor_, target, std::min(num_bytes, kMaxBytesPerCall), static_cast<off_t>(offset));
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) return file_error(file_, "cannot be read to its end");
    target += count;
    offset += static_cast<std::uintmax_t>(count);
    num_bytes -= static_cast<std::size_t>(count);
  }
  return {};
}

Result<std::string> read_file(const std::filesystem::path& file, std::uintmax_t max_bytes) {
  auto input = InputFile::open(file);
  if (!input) return input.error();
  if (input->size() > max_bytes)
    return file_error(
        file, std::to_string(input->size()) + " bytes are too many (at most " + std::to_string(max_bytes) + ")");
  // A sparse file of gigabytes takes no space on the disk, but all of it in memory.
  constexpr std::uintmax_t kLarge = std::uintmax_t{1} << 26;
  constexpr std::size_t kStart = 4096;
  if (input->size() > kLarge) {
    const auto start = read_file_start(file, kStart);
    if (!start) return start.error();
    if (start->find_first_not_of('\0') == std::string::npos)
      return file_error(file, "begins with zeros only (a hole in a sparse or damaged file?)");
  }
  return read_text(*input, input->size());
}

Result<std::string> read_file_start(const std::filesystem::path& file, std::size_t max_bytes) {
  auto input = InputFile::open(file);
  if (!input) return input.error();
  return read_text(*input, std::min<std::uintmax_t>(input->size(), max_bytes));
}

}  // namespace resight
