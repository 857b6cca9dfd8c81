// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <span>
#include <string_view>

namespace resight {

/// FNV-1a over bytes: a checksum against damage and staleness, not against an attacker. Chain by passing the last
/// hash as `seed`.
inline constexpr std::uint64_t kHashSeed = 0xCBF29CE484222325ULL;
[[nodiscard]] std::uint64_t hash_bytes(std::span<const std::uint8_t> bytes, std::uint64_t seed = kHashSeed);
[[nodiscard]] std::uint64_t hash_text(std::string_view text, std::uint64_t seed = kHashSeed);

}  // namespace resight
