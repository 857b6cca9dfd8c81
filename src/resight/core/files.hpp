// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <initializer_list>
#include <string>
#include <string_view>

#include "resight/core/result.hpp"

namespace resight {

/// Formats an error message about a file: "<file>: <what>".
[[nodiscard]] Error file_error(const std::filesystem::path& file, std::string_view what);

/// The last component of a path. Paths such as "a/b/" and "." are made absolute first.
[[nodiscard]] std::string folder_name(const std::filesystem::path& directory);

/// Checks before long work whether a file or folder can be created under this name, parent folders included. Changes
/// nothing. An existing file may be overwritten and an existing folder may be filled.
[[nodiscard]] Result<void> check_writable(const std::filesystem::path& path);

/// Writes `bytes` under a hidden temporary name beside `file`, then renames it. Creates the folder if it is missing.
[[nodiscard]] Result<void> write_file(const std::filesystem::path& file, std::string_view bytes);
/// Writes the parts one after the other.
[[nodiscard]] Result<void> write_file(const std::filesystem::path& file, std::initializer_list<std::string_view> parts);

/// Behaviour of PendingDirectory if the folder exists and is not empty.
enum class ExistingFolder {
  kRefuse,  ///< Fails, so that no data are overwritten.
  kFill,    ///< Adds files and replaces those of the same name.
};

/// A folder that is filled under a hidden temporary name. The temporary folder lies beside the final one or, if that
/// exists, inside it. Files appear under the final name only with commit(); without it, nothing remains.
class PendingDirectory {
 public:
  /// Creates the hidden folder, and the parent folders of `final_path`. Fails if these cannot be written, or if
  /// `final_path` is a file, or (with kRefuse) a folder that is not empty.
  [[nodiscard]] static Result<PendingDirectory> create(const std::filesystem::path& final_path,
                                                       ExistingFolder existing = ExistingFolder::kRefuse);
  PendingDirectory(PendingDirectory&& other) noexcept;
  PendingDirectory& operator=(PendingDirectory&& other) noexcept;
  ~PendingDirectory();
  /// The hidden folder, to be filled.
  [[nodiscard]] const std::filesystem::path& path() const { return pending_; }
  [[nodiscard]] const std::filesystem::path& final_path() const { return final_; }
  /// Moves the files to final_path(). May be called once.
  [[nodiscard]] Result<void> commit();

 private:
  PendingDirectory(std::filesystem::path final_path, std::filesystem::path pending, std::filesystem::path first_made)
      : final_(std::move(final_path)), pending_(std::move(pending)), first_made_(std::move(first_made)) {}
  void discard() noexcept;
  std::filesystem::path final_;
  std::filesystem::path pending_;     ///< Empty after commit() or a move.
  std::filesystem::path first_made_;  ///< The outermost folder that was created; empty if none.
};

}  // namespace resight
