// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "resight/core/files.hpp"
#include "resight/core/input_file.hpp"
#include "resight/core/result.hpp"

namespace resight::io {

namespace fs = std::filesystem;
using resight::file_error;
using resight::folder_name;
using resight::PendingDirectory;
using resight::read_file;
using resight::read_file_start;
using resight::write_file;

/// Limit for clouds, meshes and images.
inline constexpr std::uintmax_t kMaxBinaryBytes = std::uintmax_t{4} << 30;

/// The path that a file in `folder` refers to by `name`. Fails for an absolute name, and for one that leaves the folder
/// with "..": a data set must not make us read, or copy into results, other files of the user. Links are followed; they
/// are the user's own way to keep data elsewhere.
[[nodiscard]] Result<fs::path> path_below(const fs::path& folder, std::string_view name);

/// Names of the files (or folders) in a directory, in natural order, without hidden ones. Empty if the directory is
/// missing.
[[nodiscard]] std::vector<std::string> list_files(const fs::path& directory);
[[nodiscard]] std::vector<std::string> list_directories(const fs::path& directory);
/// Whether there is anything of this name, also a link that leads nowhere: what cannot be read is not absent.
[[nodiscard]] bool is_there(const fs::path& path);
/// Like fs::exists() and similar functions, but errors (no permission, name too long) count as false.
[[nodiscard]] bool is_file(const fs::path& path);
[[nodiscard]] bool is_folder(const fs::path& path);

/// The extension without its dot, in lower case.
[[nodiscard]] std::string extension_of(const fs::path& path);

}  // namespace resight::io
