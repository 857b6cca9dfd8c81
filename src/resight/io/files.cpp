// SPDX-License-Identifier: Apache-2.0
#include "resight/io/internal/files.hpp"

#include <algorithm>
#include <system_error>

#include "resight/io/internal/text.hpp"

namespace resight::io {
namespace {

std::vector<std::string> list_entries(const fs::path& directory, bool directories) {
  std::vector<std::string> names;
  std::error_code error;
  for (fs::directory_iterator it(directory, error), end; !error && it != end; it.increment(error)) {
    std::string name = it->path().filename().string();
    std::error_code ignored;
    if (!name.empty() && name[0] != '.' && it->is_directory(ignored) == directories) names.push_back(std::move(name));
  }
  std::ranges::sort(names, natural_less);
  return names;
}

}  // namespace

Result<fs::path> path_below(const fs::path& folder, std::string_view name) {
  const fs::path inner = fs::path(name).lexically_normal();
  if (inner.is_absolute() || (!inner.empty() && *inner.begin() == ".."))
    return Error{std::string(name) + ": lies outside the folder " + (folder.empty() ? fs::path(".") : folder).string() +
                 " (move or link it into the folder)"};
  return folder / inner;
}

std::vector<std::string> list_files(const fs::path& directory) { return list_entries(directory, false); }
std::vector<std::string> list_directories(const fs::path& directory) { return list_entries(directory, true); }

bool is_there(const fs::path& path) {
  std::error_code error;
  return fs::exists(fs::symlink_status(path, error));
}

bool is_file(const fs::path& path) {
  std::error_code error;
  return fs::is_regular_file(path, error);
}

bool is_folder(const fs::path& path) {
  std::error_code error;
  return fs::is_directory(path, error);
}

std::string extension_of(const fs::path& path) {
  std::string extension = path.extension().string();
  if (!extension.empty()) extension.erase(0, 1);
  return to_lower(extension);
}

}  // namespace resight::io
