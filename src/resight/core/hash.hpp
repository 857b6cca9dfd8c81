// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <span>
#include <string_view>

namespace resight {

/// FNV-1a over bytes. Detects damage and stale files, but not an attack. To chain calls, pass the previous hash as
/// `seed`.
inline constexpr std::uint64_t kHashSeed = 0xCBF29CE484222325ULL;
[[nodiscard]] std::uint64_t hash_bytes(std::span<const std::uint8_t> bytes, std::uint64_t seed = kHashSeed);
/// Same for the bytes of a text.
[[nodiscard]] std::uint64_t hash_text(std::string_view text, std::uint64_t seed = kHashSeed);

/// A 64-bit checksum for large files that reads 8 bytes per step (several GB/s). It always detects damage within one
/// aligned 8-byte word, and any other damage except with probability 2^-64. The value differs from hash_bytes() and is
/// the same on every little-endian platform.
[[nodiscard]] std::uint64_t checksum_bytes(std::span<const std::uint8_t> bytes, std::uint64_t seed = kHashSeed);

}  // namespace resight
