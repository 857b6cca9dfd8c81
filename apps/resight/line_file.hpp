// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <fstream>
#include <string>
#include <utility>

namespace resight::app {

/// A file that receives a line per view while `recognize` works, so that what is finished survives whatever comes next.
class LineFile {
 public:
  explicit LineFile(std::filesystem::path file) : file_(std::move(file)) {}

  /// Appends a line. The first one replaces the file of a run before. Throws an InputError if it cannot be written.
  void add(const std::string& line);
  /// Waits until all lines are on the disk. Throws an InputError if they cannot be written.
  void sync();
  void remove();

 private:
  std::filesystem::path file_;
  std::ofstream out_;
};

}  // namespace resight::app
