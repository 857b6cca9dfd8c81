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

/// A 64-bit checksum that reads 8 bytes at a step (several GB/s), for large files: any damage within one aligned 8-byte
/// word is certain to change it, any other does but for a chance of 2^-64. Not the value of hash_bytes(). The same on
/// every little-endian platform.
[[nodiscard]] std::uint64_t checksum_bytes(std::span<const std::uint8_t> bytes, std::uint64_t seed = kHashSeed);

}  // namespace resight
