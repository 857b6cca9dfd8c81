// SPDX-License-Identifier: Apache-2.0
#include "resight/core/hash.hpp"

#include <cstring>

namespace resight {

std::uint64_t hash_bytes(std::span<const std::uint8_t> bytes, std::uint64_t seed) {
  std::uint64_t hash = seed;
  for (const std::uint8_t byte : bytes) hash = (hash ^ byte) * 0x100000001B3ULL;
  return hash;
}

std::uint64_t hash_text(std::string_view text, std::uint64_t seed) {
  return hash_bytes({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()}, seed);
}

std::uint64_t checksum_bytes(std::span<const std::uint8_t> bytes, std::uint64_t seed) {
  // For a given word, each step is a bijection of the hash; for a given hash, it is a bijection of the word. A change
  // of one word therefore always changes the result.
  std::uint64_t hash = seed ^ bytes.size();
  const auto step = [&hash](const std::uint8_t* data, std::size_t size) {
    std::uint64_t word = 0;
    std::memcpy(&word, data, size);
    hash = (hash ^ word) * 0x9E3779B97F4A7C15ULL;
    hash ^= hash >> 32U;
  };
  std::size_t i = 0;
  for (; i + 8 <= bytes.size(); i += 8) step(bytes.data() + i, 8);
  if (i < bytes.size()) step(bytes.data() + i, bytes.size() - i);
  return hash;
}

}  // namespace resight
