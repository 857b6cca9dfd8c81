// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <string_view>

namespace resight {

/// CRC-32 of PNG, MCAP and zip (polynomial 0xEDB88320). Detects damage, but not an attack.
[[nodiscard]] std::uint32_t compute_crc32(std::string_view bytes);

}  // namespace resight
