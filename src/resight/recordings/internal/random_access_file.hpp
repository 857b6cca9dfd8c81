// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <filesystem>
#include <string>
#include <utility>

#include "resight/core/input_file.hpp"
#include "resight/core/result.hpp"

namespace resight::recordings {

/// A regular file, read at any place. May be read from several threads.
class RandomAccessFile {
 public:
  [[nodiscard]] static Result<RandomAccessFile> open(const std::filesystem::path& file);

  [[nodiscard]] std::uint64_t size() const { return input_.size(); }
  [[nodiscard]] const std::filesystem::path& path() const { return file_; }
  /// Reads `count` bytes. Fails if the file has fewer there, before memory is allocated.
  [[nodiscard]] Result<std::string> read(std::uint64_t offset, std::uint64_t count) const;

 private:
  RandomAccessFile(std::filesystem::path file, InputFile input) : file_(std::move(file)), input_(std::move(input)) {}
  std::filesystem::path file_;
  InputFile input_;
};

}  // namespace resight::recordings
