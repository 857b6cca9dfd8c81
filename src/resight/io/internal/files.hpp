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

/// Text files of poses, headers and annotations are never larger; a larger one is not what its name says.
inline constexpr std::uintmax_t kMaxTextBytes = std::uintmax_t{512} << 20;
/// Largest cloud, mesh or image file we read.
inline constexpr std::uintmax_t kMaxBinaryBytes = std::uintmax_t{4} << 30;

/// The bytes of a regular file.
[[nodiscard]] Result<std::string> read_file(const fs::path& file, std::uintmax_t max_bytes = kMaxTextBytes);
/// At most the first `max_bytes` bytes.
[[nodiscard]] Result<std::string> read_file_start(const fs::path& file, std::size_t max_bytes);

/// Names of the files (or folders) in a directory, in natural order; hidden ones are left out. Empty if there is none.
[[nodiscard]] std::vector<std::string> list_files(const fs::path& directory);
[[nodiscard]] std::vector<std::string> list_directories(const fs::path& directory);
/// Like fs::exists and friends, but an error (no permission, name too long) is a no.
[[nodiscard]] bool is_file(const fs::path& path);
[[nodiscard]] bool is_folder(const fs::path& path);

/// The extension without its dot, in small letters.
[[nodiscard]] std::string extension_of(const fs::path& path);

}  // namespace resight::io
