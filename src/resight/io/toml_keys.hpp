// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string_view>

#include "resight/core/result.hpp"

namespace resight {

/// To be called before a TOML document is parsed: toml++ calls itself for each part of a dotted key, and very many
/// parts would exhaust the stack. The error names the line, but not the file.
[[nodiscard]] Result<void> check_toml_keys(std::string_view text);

}  // namespace resight
