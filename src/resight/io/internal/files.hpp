// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "resight/core/files.hpp"
#include "resight/core/result.hpp"

namespace resight::io {

namespace fs = std::filesystem;
using resight::file_error;
using resight::folder_name;
using resight::PendingDirectory;
using resight::write_file;

/// Limit for text files of poses, headers and annotations. A larger file cannot be one of them.
inline constexpr std::uintmax_t kMaxTextBytes = std::uintmax_t{512} << 20;
/// Limit for clouds, meshes and images.
inline constexpr std::uintmax_t kMaxBinaryBytes = std::uintmax_t{4} << 30;

/// Reads all bytes of a regular file.
[[nodiscard]] Result<std::string> read_file(const fs::path& file, std::uintmax_t max_bytes = kMaxTextBytes);
/// Reads the first bytes of a file, at most `max_bytes`.
[[nodiscard]] Result<std::string> read_file_start(const fs::path& file, std::size_t max_bytes);

/// Names of the files (or folders) in a directory, in natural order, without hidden ones. Empty if the directory is
/// missing.
[[nodiscard]] std::vector<std::string> list_files(const fs::path& directory);
[[nodiscard]] std::vector<std::string> list_directories(const fs::path& directory);
/// Like fs::exists() and similar functions, but errors (no permission, name too long) count as false.
[[nodiscard]] bool is_file(const fs::path& path);
[[nodiscard]] bool is_folder(const fs::path& path);

/// The extension without its dot, in lower case.
[[nodiscard]] std::string extension_of(const fs::path& path);

}  // namespace resight::io
