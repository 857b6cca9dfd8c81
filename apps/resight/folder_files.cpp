// SPDX-License-Identifier: Apache-2.0
#include "folder_files.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "commands.hpp"

namespace resight::app {

namespace fs = std::filesystem;

std::vector<fs::path> list_files(const fs::path& folder, const fs::path& skipped) {
  std::vector<fs::path> files;
  std::error_code error;
  if (!fs::is_directory(folder, error)) return files;
  std::set<fs::path> visited{fs::canonical(folder, error), fs::weakly_canonical(skipped, error)};
  const auto options = fs::directory_options::follow_directory_symlink | fs::directory_options::skip_permission_denied;
  for (fs::recursive_directory_iterator it(folder, options, error), end; !error && it != end; it.increment(error)) {
    std::error_code unreadable;
    if (it->is_regular_file(unreadable)) files.push_back(it->path());
    const bool is_folder = it->is_directory(unreadable);
    if (unreadable || (is_folder && !visited.insert(fs::canonical(it->path(), unreadable)).second))
      it.disable_recursion_pending();
  }
  if (error) throw InputError(fmt::format("{}: cannot be listed ({})", folder.string(), error.message()));
  std::ranges::sort(files);
  return files;
}

std::string describe_files(const fs::path& file_or_folder, const fs::path& skipped) {
  std::error_code error;
  const std::vector<fs::path> files = fs::is_directory(file_or_folder, error) ? list_files(file_or_folder, skipped)
                                                                              : std::vector<fs::path>{file_or_folder};
  std::string text;
  for (const fs::path& file : files) {
    const auto size = fs::file_size(file, error);
    const auto time = fs::last_write_time(file, error).time_since_epoch().count();
    text += fmt::format("{} {} {}\n", file.lexically_relative(file_or_folder).string(), size, time);
  }
  return text;
}

}  // namespace resight::app
