// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <string_view>
#include <system_error>
#include <vector>

#include "resight/core/result.hpp"

namespace resight {

/// The journal of a transfer, in the folder that is filled. While it is there, the folder is a mixture.
inline constexpr std::string_view kTransferJournal = ".resight-unfinished";

/// Moves files into an existing folder. All or none: if one cannot be moved, the others are moved back, and if the
/// process is killed, undo() does it later by the journal.
class FileTransfer {
 public:
  /// `from` is a locked folder in `to` or beside it. Both paths are absolute.
  FileTransfer(std::filesystem::path from, std::filesystem::path to);
  [[nodiscard]] Result<void> run();

  /// The steps of run(): makes the folders and writes the journal; moves one file; removes the journal and `from`.
  [[nodiscard]] Result<void> begin();
  [[nodiscard]] std::error_code move(std::size_t file);
  void end();
  [[nodiscard]] std::size_t num_files() const { return files_.size(); }

  /// Undoes the transfer into this folder whose process was killed. Does nothing if there is none, or if its process
  /// still lives.
  [[nodiscard]] static Result<void> undo(const std::filesystem::path& to);

 private:
  [[nodiscard]] Result<void> list();
  [[nodiscard]] Result<void> write_journal() const;
  [[nodiscard]] bool read_journal();
  [[nodiscard]] bool is_inside(const std::filesystem::path& name) const;
  void move_back(std::size_t file) const;
  void remove_new_folders() const;
  [[nodiscard]] std::filesystem::path replaced(std::size_t file) const;

  std::filesystem::path from_;
  std::filesystem::path to_;
  std::filesystem::path replaced_;                  ///< Holds the files that are replaced, until all are.
  std::vector<std::filesystem::path> new_folders_;  ///< Below `to`; outer ones first.
  std::vector<std::filesystem::path> files_;
};

}  // namespace resight
