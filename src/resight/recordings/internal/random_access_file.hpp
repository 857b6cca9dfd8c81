// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <filesystem>
#include <string>

#include "resight/core/result.hpp"

namespace resight::recordings {

/// A regular file, read at any place. May be read from several threads.
class RandomAccessFile {
 public:
  [[nodiscard]] static Result<RandomAccessFile> open(const std::filesystem::path& file);
  RandomAccessFile(RandomAccessFile&& other) noexcept;
  RandomAccessFile& operator=(RandomAccessFile&& other) = delete;
  ~RandomAccessFile();

  [[nodiscard]] std::uint64_t size() const { return size_; }
  [[nodiscard]] const std::filesystem::path& path() const { return file_; }
  /// Reads `count` bytes. Fails if the file has fewer there, before memory is allocated.
  [[nodiscard]] Result<std::string> read(std::uint64_t offset, std::uint64_t count) const;

 private:
  RandomAccessFile(std::filesystem::path file, int descriptor, std::uint64_t size)
      : file_(std::move(file)), descriptor_(descriptor), size_(size) {}
  std::filesystem::path file_;
  int descriptor_;  ///< -1 after a move.
  std::uint64_t size_;
};

}  // namespace resight::recordings
