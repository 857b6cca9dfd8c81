// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string_view>

namespace resight {

/// Writes all bytes to an open file. Returns 0, or the error number.
[[nodiscard]] int write_all(int descriptor, std::string_view bytes);

}  // namespace resight
