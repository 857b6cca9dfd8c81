// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <cstdint>
#include <span>
#include <type_traits>

#include "resight/core/hash.hpp"

namespace resight::annotation {

/// Of the bytes of the values.
template <typename T>
[[nodiscard]] std::uint64_t hash_values(std::span<const T> values, std::uint64_t seed) {
  static_assert(std::has_unique_object_representations_v<T> || std::is_floating_point_v<T>);
  const std::span<const std::byte> bytes = std::as_bytes(values);
  return checksum_bytes({reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()}, seed);
}

}  // namespace resight::annotation
