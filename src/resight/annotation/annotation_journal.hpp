// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "resight/core/result.hpp"

namespace resight {

/// A file that only grows: one header line, then one line per action. A line is on the disk when append() returns, so
/// a process that dies loses no action that was acknowledged. The file is locked (flock) while it is open. The lock
/// ends with the process, however it ends.
class AnnotationJournal {
 public:
  struct Opened;
  /// Opens the journal, or starts it with the first of `headers` if it does not exist or is empty. A last line that is
  /// cut off or that `is_valid` refuses is removed: the process died while it wrote it. Fails if another process has it
  /// open, its header is none of `headers`, or an earlier line is not valid.
  [[nodiscard]] static Result<Opened> open(const std::filesystem::path& file, const std::vector<std::string>& headers,
                                           const std::function<bool(std::string_view)>& is_valid);
  AnnotationJournal(AnnotationJournal&& other) noexcept;
  AnnotationJournal& operator=(AnnotationJournal&& other) = delete;
  ~AnnotationJournal();

  /// Writes a line, which holds no line break, and waits until it is on the disk. If that fails, the file is as before.
  [[nodiscard]] Result<void> append(std::string_view line);

 private:
  AnnotationJournal(std::filesystem::path file, int descriptor, std::size_t size)
      : file_(std::move(file)), descriptor_(descriptor), size_(size) {}
  std::filesystem::path file_;
  int descriptor_;    ///< -1 after a move.
  std::size_t size_;  ///< Bytes of whole lines.
};

struct AnnotationJournal::Opened {
  AnnotationJournal journal;
  std::vector<std::string> lines;  ///< Without the header.
  bool was_cut_off = false;        ///< A last line was removed.
};

}  // namespace resight
