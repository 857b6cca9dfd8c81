// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <string>
#include <vector>

namespace resight::app {

/// All files of a folder in order of name, also below symbolic links: data sets often link to their images. Each folder
/// counts once, however many links lead to it. `skipped`, and folders that the user may not read, do not count. Empty
/// for a folder that does not exist. Throws InputError if it cannot be listed.
[[nodiscard]] std::vector<std::filesystem::path> list_files(const std::filesystem::path& folder,
                                                            const std::filesystem::path& skipped = {});

/// Name, size and time of the last change of a file, or of all files of a folder but those below `skipped`: one line
/// each. Tells most changes of content without reading it.
[[nodiscard]] std::string describe_files(const std::filesystem::path& file_or_folder,
                                         const std::filesystem::path& skipped = {});

}  // namespace resight::app
