// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "resight/core/result.hpp"

namespace resight::io {

namespace fs = std::filesystem;

/// Text files of poses, headers and annotations are never larger; a larger one is not what its name says.
inline constexpr std::uintmax_t kMaxTextBytes = std::uintmax_t{512} << 20;
/// Largest cloud, mesh or image file we read.
inline constexpr std::uintmax_t kMaxBinaryBytes = std::uintmax_t{4} << 30;

/// "<file>: <what>", the form of all our error messages.
[[nodiscard]] Error file_error(const fs::path& file, std::string_view what);

/// The bytes of a regular file.
[[nodiscard]] Result<std::string> read_file(const fs::path& file, std::uintmax_t max_bytes = kMaxTextBytes);
/// At most the first `max_bytes` bytes.
[[nodiscard]] Result<std::string> read_file_start(const fs::path& file, std::size_t max_bytes);
/// Writes under a temporary name beside `file` and renames it at the end; creates the folder.
[[nodiscard]] Result<void> write_file(const fs::path& file, std::string_view bytes);

/// Names of the files (or folders) in a directory, in natural order; hidden ones are left out. Empty if there is none.
[[nodiscard]] std::vector<std::string> list_files(const fs::path& directory);
[[nodiscard]] std::vector<std::string> list_directories(const fs::path& directory);
/// Like fs::exists and friends, but an error (no permission, name too long) is a no.
[[nodiscard]] bool is_file(const fs::path& path);
[[nodiscard]] bool is_folder(const fs::path& path);

/// The extension without its dot, in small letters.
[[nodiscard]] std::string extension_of(const fs::path& path);
/// The last part of a path's name, also for "a/b/" and "." (made absolute).
[[nodiscard]] std::string folder_name(const fs::path& directory);

/// A directory that is filled under a temporary sibling name and appears under its own name only with commit().
/// Without it, nothing remains.
class PendingDirectory {
 public:
  /// Fails if `final_path` exists and is not an empty directory: we never write over data.
  [[nodiscard]] static Result<PendingDirectory> create(const fs::path& final_path);
  PendingDirectory(PendingDirectory&& other) noexcept;
  PendingDirectory& operator=(PendingDirectory&& other) noexcept;
  ~PendingDirectory();
  [[nodiscard]] const fs::path& path() const { return pending_; }
  [[nodiscard]] const fs::path& final_path() const { return final_; }
  [[nodiscard]] Result<void> commit();

 private:
  PendingDirectory(fs::path final_path, fs::path pending)
      : final_(std::move(final_path)), pending_(std::move(pending)) {}
  void discard() noexcept;
  fs::path final_;
  fs::path pending_;  ///< Empty once committed or moved from.
};

}  // namespace resight::io
