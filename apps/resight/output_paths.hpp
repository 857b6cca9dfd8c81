// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace resight::app {

using Paths = std::vector<std::filesystem::path>;

// One rule for all outputs: an input is never replaced, nor is a file that the command did not write. Only in an output
// folder, files with the fixed names of our results are. All functions throw an InputError, before any work is done.

/// For a file to write. It may exist only if it begins with `signature`, as files of this `kind` do.
void check_output_file(const std::filesystem::path& out, std::string_view signature, std::string_view kind,
                       const Paths& inputs);

/// For a file to write that must not exist.
void check_new_file(const std::filesystem::path& out);

/// For a folder that `command` fills. It is new, or empty, or holds results of that command, which are known by how
/// they begin. It may not hold a folder that is called like a result (report.html).
void check_output_folder(const std::filesystem::path& out, std::string_view command, const Paths& inputs);

/// For a folder to write, which must be empty or not exist.
void check_new_folder(const std::filesystem::path& out);

/// For all outputs of one call: none has the name of another or lies below it.
void check_apart(const Paths& outputs);

/// The path as seen from `folder`, links resolved, so that results find their inputs wherever they are called from, and
/// after both were moved.
[[nodiscard]] std::string path_from(const std::filesystem::path& folder, const std::filesystem::path& path);

}  // namespace resight::app
