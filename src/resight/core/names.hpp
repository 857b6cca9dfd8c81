// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string_view>

#include "resight/core/result.hpp"

namespace resight {

/// Checks the name of an object from a file. A name has 1 to 200 bytes, no control characters and no slashes, and is
/// neither "." nor "..", because it becomes part of lines and paths. The error does not name the file.
[[nodiscard]] Result<void> check_object_name(std::string_view name);

}  // namespace resight
