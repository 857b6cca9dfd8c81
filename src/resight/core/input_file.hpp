// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <filesystem>
#include <string>
#include <utility>

#include "resight/core/result.hpp"

namespace resight {

/// Limit for text files: poses, settings, annotations. A larger file cannot be one of them.
inline constexpr std::uintmax_t kMaxTextBytes = std::uintmax_t{512} << 20;

/// A regular file, open for reading. Pipes and devices are refused without waiting for them, because they need not end.
class InputFile {
 public:
  [[nodiscard]] static Result<InputFile> open(const std::filesystem::path& file);
  InputFile(InputFile&& other) noexcept;
  InputFile& operator=(InputFile&& other) = delete;
  ~InputFile();

  /// The size in bytes when the file was opened, or at the last update_size().
  [[nodiscard]] std::uintmax_t size() const { return size_; }
  /// Finds the size of a file that is still being written.
  [[nodiscard]] Result<void> update_size();
  /// Reads the next bytes. Fails if there are fewer.
  [[nodiscard]] Result<void> read(void* bytes, std::size_t num_bytes);
  /// Reads bytes from a place, counted from the start of the file. read() goes on where it was.
  [[nodiscard]] Result<void> read_at(std::uintmax_t offset, void* bytes, std::size_t num_bytes) const;

 private:
  InputFile(std::filesystem::path file, int descriptor, std::uintmax_t size)
      : file_(std::move(file)), descriptor_(descriptor), size_(size) {}
  std::filesystem::path file_;
  int descriptor_;  ///< -1 after a move.
  std::uintmax_t size_;
};

/// Reads all bytes of a regular file. Fails if there are more than `max_bytes`.
[[nodiscard]] Result<std::string> read_file(const std::filesystem::path& file,
                                            std::uintmax_t max_bytes = kMaxTextBytes);
/// Reads the first bytes of a regular file, at most `max_bytes`.
[[nodiscard]] Result<std::string> read_file_start(const std::filesystem::path& file, std::size_t max_bytes);

}  // namespace resight
