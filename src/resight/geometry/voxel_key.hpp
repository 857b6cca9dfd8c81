// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <cmath>
#include <cstdint>

namespace resight {

/// Packs the index of the cube of side 1 / inverse_size that contains a point into 64 bits, 21 bits per axis (a range
/// of +-5 km at 5 mm). Within that range, keys are equal if and only if the cubes are.
[[nodiscard]] inline std::uint64_t voxel_key(int ix, int iy, int iz) {
  constexpr std::uint64_t kMask = (1ULL << 21U) - 1U;
  return ((static_cast<std::uint64_t>(ix) & kMask) << 42U) | ((static_cast<std::uint64_t>(iy) & kMask) << 21U) |
         (static_cast<std::uint64_t>(iz) & kMask);
}
/// Index of the cube of side 1 / inverse_size that contains a point.
[[nodiscard]] inline Eigen::Vector3i voxel_index(const Eigen::Vector3f& p, float inverse_size) {
  return {static_cast<int>(std::floor(p.x() * inverse_size)), static_cast<int>(std::floor(p.y() * inverse_size)),
          static_cast<int>(std::floor(p.z() * inverse_size))};
}
/// Key of the cube of side 1 / inverse_size that contains a point.
[[nodiscard]] inline std::uint64_t voxel_key(const Eigen::Vector3f& p, float inverse_size) {
  const Eigen::Vector3i i = voxel_index(p, inverse_size);
  return voxel_key(i.x(), i.y(), i.z());
}
/// Spreads voxel keys over a power-of-two table (Fibonacci hashing keeps the high bits).
[[nodiscard]] inline std::uint64_t mix_key(std::uint64_t key) {
  key ^= key >> 32U;
  key *= 0x9E3779B97F4A7C15ULL;
  return key ^ (key >> 29U);
}

}  // namespace resight
