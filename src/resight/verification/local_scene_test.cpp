// SPDX-License-Identifier: Apache-2.0
#include "resight/verification/local_scene.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <optional>
#include <set>

#include "resight/core/random.hpp"

namespace resight {
namespace {

Eigen::Vector3f random_point(Rng& rng, double size_m) {
  return {static_cast<float>(size_m * rng.uniform()), static_cast<float>(size_m * rng.uniform()),
          static_cast<float>(size_m * rng.uniform())};
}

class LocalSceneTest : public ::testing::Test {
 protected:
  LocalSceneTest() {
    Rng rng(5);
    for (int i = 0; i < 2000; ++i) scene_.push_back(random_point(rng, 0.5));
    for (int i = 0; i < 30; ++i) around_.emplace_back(random_point(rng, 0.15).array() + 0.15F);
    for (int i = 0; i < 300; ++i) queries_.emplace_back(random_point(rng, 0.6).array() - 0.05F);
    blocks_ = BlockGrid(scene_, 0.05);
    local_.emplace(scene_, blocks_, around_, 0.03F, 0.01F);
  }
  std::vector<Eigen::Vector3f> scene_, around_, queries_;
  BlockGrid blocks_;
  std::optional<LocalScene> local_;
};

TEST_F(LocalSceneTest, HoldsThePointsOfTheBox) {
  Eigen::AlignedBox3f box;
  for (const Eigen::Vector3f& p : around_) box.extend(p);
  box.min().array() -= 0.03F;
  box.max().array() += 0.03F;
  std::set<int> expected;
  for (std::size_t i = 0; i < scene_.size(); ++i)
    if (box.contains(scene_[i])) expected.insert(static_cast<int>(i));
  std::set<int> found;
  for (std::size_t i = 0; i < local_->size(); ++i) {
    found.insert(local_->scene_index(i));
    EXPECT_EQ(local_->point(i), scene_[static_cast<std::size_t>(local_->scene_index(i))]);
  }
  EXPECT_EQ(found, expected);
  EXPECT_GT(found.size(), 50U);
  EXPECT_LT(found.size(), scene_.size() / 2);
}

TEST_F(LocalSceneTest, NeighboursAreThoseOfBruteForceInThePartThatIsKept) {
  std::vector<std::uint8_t> kept(local_->size());
  for (std::size_t i = 0; i < kept.size(); ++i) kept[i] = i % 3 == 0 ? 1 : 0;
  const LocalScene part = local_->subset(kept);
  EXPECT_EQ(part.size(), (kept.size() + 2) / 3);
  for (const Eigen::Vector3f& query : around_) {
    std::set<int> found;
    part.visit_within(query, 0.025F, [&](std::size_t i, float distance_sq) {
      EXPECT_FLOAT_EQ(distance_sq, (part.point(i) - query).squaredNorm());
      found.insert(part.scene_index(i));
      return true;
    });
    std::set<int> expected;
    for (std::size_t i = 0; i < kept.size(); ++i)
      if (kept[i] != 0 && (local_->point(i) - query).squaredNorm() <= 0.025F * 0.025F)
        expected.insert(local_->scene_index(i));
    EXPECT_EQ(found, expected);
  }
}

}  // namespace
}  // namespace resight
