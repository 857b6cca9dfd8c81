// SPDX-License-Identifier: Apache-2.0
#include "resight/features/feature_set.hpp"

#include <gtest/gtest.h>

#include <stdexcept>

namespace resight {
namespace {

FeatureSet make_set(int n, int dimension, FeatureType type) {
  FeatureSet set{.type = type, .dimension = dimension, .points = {}, .normals = {}, .descriptors = {}};
  for (int i = 0; i < n; ++i) {
    set.points.emplace_back(static_cast<float>(i), 2.0F, -1.0F);
    set.normals.emplace_back(0.0F, 0.0F, 1.0F);
    for (int d = 0; d < dimension; ++d) set.descriptors.push_back(static_cast<float>(100 * i + d));
  }
  return set;
}

TEST(FeatureSet, AppendsRowsInOrder) {
  FeatureSet set = make_set(2, 3, FeatureType::kShot);
  set.append(make_set(1, 3, FeatureType::kShot));
  ASSERT_EQ(set.size(), 3U);
  EXPECT_EQ(set.normals.size(), 3U);
  EXPECT_EQ(set.descriptors.size(), 9U);
  EXPECT_EQ(set.descriptor(1)[2], 102.0F);
  EXPECT_EQ(set.descriptor(2)[0], 0.0F);
  EXPECT_EQ(set.descriptor(2).size(), 3U);
}

TEST(FeatureSet, TakesOnWhatIsAppendedToAnEmptySet) {
  FeatureSet set;
  set.append(make_set(2, 5, FeatureType::kShot));
  EXPECT_EQ(set.type, FeatureType::kShot);
  EXPECT_EQ(set.dimension, 5);
  set.append(FeatureSet{});  // an empty set of any type can be appended
  EXPECT_EQ(set.size(), 2U);
}

TEST(FeatureSet, RefusesToMixDescriptors) {
  FeatureSet set = make_set(2, 3, FeatureType::kShot);
  EXPECT_THROW(set.append(make_set(1, 3, FeatureType::kSift)), std::invalid_argument);
  EXPECT_THROW(set.append(make_set(1, 4, FeatureType::kShot)), std::invalid_argument);
  EXPECT_EQ(set.size(), 2U);
}

TEST(TransformFeatures, MovesPointsAndRotatesNormals) {
  const FeatureSet before = make_set(4, 3, FeatureType::kSift);
  const Rigid3 motion{Rigid3::from_axis_angle({1, 2, 3}, 0.7).rotation, {0.1, -0.2, 0.3}};
  const FeatureSet after = transform(motion, before);
  for (std::size_t i = 0; i < before.size(); ++i) {
    EXPECT_LT((after.points[i].cast<double>() - motion * before.points[i].cast<double>()).norm(), 1e-5);
    EXPECT_LT((after.normals[i].cast<double>() - motion.rotation * before.normals[i].cast<double>()).norm(), 1e-5);
  }
  EXPECT_EQ(after.descriptors, before.descriptors);
  const FeatureSet back = transform(motion.inverse(), after);
  for (std::size_t i = 0; i < before.size(); ++i) EXPECT_LT((back.points[i] - before.points[i]).norm(), 1e-5F);
}

}  // namespace
}  // namespace resight
