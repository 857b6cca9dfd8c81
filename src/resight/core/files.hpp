// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <initializer_list>
#include <string>
#include <string_view>

#include "resight/core/result.hpp"

namespace resight {

/// "<file>: <what>", the form of the error messages on files.
[[nodiscard]] Error file_error(const std::filesystem::path& file, std::string_view what);

/// The last part of a path's name, also for "a/b/" and "." (made absolute).
[[nodiscard]] std::string folder_name(const std::filesystem::path& directory);

/// Whether a file or folder could be made under this name, its folders included; to be asked before long work. Changes
/// nothing. An existing file may be written over, an existing folder may be filled.
[[nodiscard]] Result<void> check_writable(const std::filesystem::path& path);

/// Writes under a hidden temporary name beside `file` and renames it at the end; makes its folder if it is missing.
[[nodiscard]] Result<void> write_file(const std::filesystem::path& file, std::string_view bytes);
/// The parts, one after the other.
[[nodiscard]] Result<void> write_file(const std::filesystem::path& file, std::initializer_list<std::string_view> parts);

/// What PendingDirectory does where the folder exists already and is not empty.
enum class ExistingFolder {
  kRefuse,  ///< It is an error: never write over data.
  kFill,    ///< Files are added; those of the same name are replaced.
};

/// A folder that is filled under a hidden temporary name, beside its own or (if it exists) within it. What was written
/// appears under its name only with commit(). Without it, nothing remains.
class PendingDirectory {
 public:
  [[nodiscard]] static Result<PendingDirectory> create(const std::filesystem::path& final_path,
                                                       ExistingFolder existing = ExistingFolder::kRefuse);
  PendingDirectory(PendingDirectory&& other) noexcept;
  PendingDirectory& operator=(PendingDirectory&& other) noexcept;
  ~PendingDirectory();
  [[nodiscard]] const std::filesystem::path& path() const { return pending_; }
  [[nodiscard]] const std::filesystem::path& final_path() const { return final_; }
  /// To be called once.
  [[nodiscard]] Result<void> commit();

 private:
  PendingDirectory(std::filesystem::path final_path, std::filesystem::path pending, std::filesystem::path first_made)
      : final_(std::move(final_path)), pending_(std::move(pending)), first_made_(std::move(first_made)) {}
  void discard() noexcept;
  std::filesystem::path final_;
  std::filesystem::path pending_;     ///< Empty once committed or moved from.
  std::filesystem::path first_made_;  ///< The outermost folder that had to be made; empty if none.
};

}  // namespace resight
