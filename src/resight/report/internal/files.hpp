// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <string_view>

#include "resight/core/result.hpp"

namespace resight::report {

/// Writes a file so that it appears under its name only when it is whole; its folder is made if it is missing.
[[nodiscard]] Result<void> write_whole_file(const std::filesystem::path& path, std::string_view bytes);

}  // namespace resight::report
