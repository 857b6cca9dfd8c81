// SPDX-License-Identifier: Apache-2.0
#include "resight/geometry/voxel_map.hpp"

#include <gtest/gtest.h>

#include <set>
#include <unordered_map>

#include "resight/core/random.hpp"

namespace resight {
namespace {

TEST(VoxelKey, EqualExactlyForTheSameCube) {
  std::set<std::uint64_t> keys;
  for (int x = -5; x <= 5; ++x)
    for (int y = -5; y <= 5; ++y)
      for (int z = -5; z <= 5; ++z) {
        keys.insert(voxel_key(x, y, z));
        const Eigen::Vector3f inside((static_cast<float>(x) + 0.3F) * 0.5F, (static_cast<float>(y) + 0.6F) * 0.5F,
                                     (static_cast<float>(z) + 0.9F) * 0.5F);
        ASSERT_EQ(voxel_key(inside, 2.0F), voxel_key(x, y, z));
        ASSERT_EQ(voxel_index(inside, 2.0F), Eigen::Vector3i(x, y, z));
      }
  EXPECT_EQ(keys.size(), 11U * 11U * 11U);
  constexpr int kLimit = 1 << 20;
  EXPECT_NE(voxel_key(kLimit - 1, 0, 0), voxel_key(-kLimit, 0, 0));
  EXPECT_NE(voxel_key(0, -1, 0), voxel_key(-1, 0, 0));
  EXPECT_NE(voxel_key(0, 0, -1), voxel_key(0, -1, 0));
}

// Keys are drawn with repetitions and cause many rehashes of the smallest table.
TEST(VoxelMap, AgreesWithUnorderedMap) {
  for (const std::uint32_t range : {50U, 3000U, 1U << 20U}) {
    Rng rng(range);
    VoxelMap map(0);
    std::unordered_map<std::uint64_t, int> oracle;
    for (int i = 0; i < 20000; ++i) {
      const int y = static_cast<int>(rng.below(3));
      const std::uint64_t key = voxel_key(static_cast<int>(rng.below(range)) - 20, y, -1);
      ASSERT_EQ(map.find(key), oracle.contains(key) ? oracle[key] : VoxelMap::kNotFound);
      const int expected = oracle.emplace(key, static_cast<int>(oracle.size())).first->second;
      ASSERT_EQ(map.insert(key), expected);
      ASSERT_EQ(map.size(), oracle.size());
    }
    for (const auto& [key, number] : oracle) ASSERT_EQ(map.find(key), number);
  }
}

TEST(VoxelMap, KeyZeroIsAKeyLikeOthers) {
  VoxelMap map(4);
  EXPECT_EQ(map.find(0), VoxelMap::kNotFound);
  EXPECT_EQ(map.insert(7), 0);
  EXPECT_EQ(map.find(0), VoxelMap::kNotFound);
  EXPECT_EQ(map.insert(0), 1);
  EXPECT_EQ(map.insert(0), 1);
  EXPECT_EQ(map.find(0), 1);
  for (std::uint64_t key = 100; key < 1000; ++key) map.insert(key);
  EXPECT_EQ(map.find(0), 1);
  EXPECT_EQ(map.find(7), 0);
}

TEST(VoxelMap, HoldsTheKeysOfADenseBlock) {
  VoxelMap map;
  int expected = 0;
  for (int x = 0; x < 60; ++x)
    for (int y = 0; y < 60; ++y)
      for (int z = 0; z < 20; ++z) ASSERT_EQ(map.insert(voxel_key(x, y, z)), expected++);
  EXPECT_EQ(map.size(), 72000U);
}

}  // namespace
}  // namespace resight
