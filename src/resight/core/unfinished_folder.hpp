// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>

#include "resight/core/result.hpp"

namespace resight {

/// Fails if a command is moving its files into the folder or into one above it, or was killed while it did: then old
/// and new files are mixed. Readers of results and data sets call it for the folder that they were given, and again for
/// each one below it that they open. The next command that writes into the folder undoes what the killed one had begun.
[[nodiscard]] Result<void> check_finished(const std::filesystem::path& folder);

}  // namespace resight
