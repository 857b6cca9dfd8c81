// SPDX-License-Identifier: Apache-2.0
#include "resight/training/feature_reduction.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "resight/core/random.hpp"

namespace resight {
namespace {

constexpr int kDimension = 16;

void add_feature(FeatureSet& set, const Eigen::Vector3f& point, Eigen::VectorXf descriptor,
                 const Eigen::Vector3f& normal = Eigen::Vector3f::UnitZ()) {
  set.dimension = kDimension;
  descriptor.normalize();
  set.points.push_back(point);
  set.normals.push_back(normal);
  set.descriptors.insert(set.descriptors.end(), descriptor.data(), descriptor.data() + kDimension);
}

Eigen::VectorXf random_descriptor(Rng& rng) {
  Eigen::VectorXf d(kDimension);
  for (float& x : d) x = static_cast<float>(rng.uniform());
  return d.normalized();
}

// Features of `places` distant places, each observed `times` times with small errors of point and descriptor.
FeatureSet make_repeated(int places, int times, std::uint64_t seed) {
  Rng rng(seed);
  std::vector<Eigen::Vector3f> points;
  std::vector<Eigen::VectorXf> descriptors;
  for (int i = 0; i < places; ++i) {
    points.emplace_back(0.02F * static_cast<float>(i % 10), 0.02F * static_cast<float>(i / 10), 0.0F);
    descriptors.push_back(random_descriptor(rng));
  }
  FeatureSet set;
  for (int t = 0; t < times; ++t)
    for (int i = 0; i < places; ++i) {
      const auto jitter = [&] { return static_cast<float>(rng.uniform(-0.0005, 0.0005)); };
      Eigen::VectorXf d = descriptors[i];
      for (float& x : d) x = std::abs(x + 10 * jitter());
      add_feature(set, points[i] + Eigen::Vector3f(jitter(), jitter(), jitter()), d);
    }
  return set;
}

const FeatureMerging kMerging{.max_distance_m = 0.005, .max_descriptor_distance = 0.2};

TEST(MergeSimilarFeatures, LeavesOneOfEachRepetition) {
  const FeatureSet merged = merge_similar_features(make_repeated(50, 6, 1), kMerging);
  ASSERT_EQ(merged.size(), 50U);
  ASSERT_EQ(merged.descriptors.size(), 50U * kDimension);
  for (int i = 0; i < 50; ++i) {  // in order of the first feature of each place
    const Eigen::Vector3f place(0.02F * static_cast<float>(i % 10), 0.02F * static_cast<float>(i / 10), 0.0F);
    EXPECT_LT((merged.points[i] - place).norm(), 0.0005F);
    EXPECT_NEAR(merged.normals[i].norm(), 1, 1e-5);
    EXPECT_NEAR(Eigen::Map<const Eigen::VectorXf>(merged.descriptor(i).data(), kDimension).norm(), 1, 1e-5);
  }
}

// Each original must lie roughly within the limits of the mean of some group, and no group may mix features that are
// more than twice the limit apart.
TEST(MergeSimilarFeatures, EachFeatureKeepsAStandIn) {
  Rng rng(2);
  FeatureSet set;
  for (int i = 0; i < 600; ++i) {
    const auto coordinate = [&] { return static_cast<float>(rng.uniform(0, 0.03)); };
    add_feature(set, {coordinate(), coordinate(), coordinate()}, random_descriptor(rng));
  }
  const FeatureMerging merging{.max_distance_m = 0.01, .max_descriptor_distance = 0.5};
  const FeatureSet merged = merge_similar_features(set, merging);
  ASSERT_GT(merged.size(), 50U);
  ASSERT_LT(merged.size(), 550U);
  for (std::size_t i = 0; i < set.size(); ++i) {
    bool found = false;
    for (std::size_t j = 0; j < merged.size() && !found; ++j) {
      const auto d = Eigen::Map<const Eigen::VectorXf>(set.descriptor(i).data(), kDimension) -
                     Eigen::Map<const Eigen::VectorXf>(merged.descriptor(j).data(), kDimension);
      found = (set.points[i] - merged.points[j]).norm() <= 0.02F && d.norm() <= 1.0F;
    }
    ASSERT_TRUE(found) << i;
  }
}

TEST(MergeSimilarFeatures, KeepsApartWhatDiffersInPlaceDescriptorOrSide) {
  Rng rng(3);
  const Eigen::VectorXf a = random_descriptor(rng);
  Eigen::VectorXf b = Eigen::VectorXf::Zero(kDimension);
  b(3) = 1;
  FeatureSet set;
  add_feature(set, {0, 0, 0}, a);
  add_feature(set, {0.0051F, 0, 0}, a);                   // too far away
  add_feature(set, {0, 0, 0}, b);                         // another descriptor
  add_feature(set, {0, 0, 0.001F}, a, {0, 0, -1});        // the other side of a thin wall
  add_feature(set, {-0.001F, 0, 0}, a, {0, 0.6F, 0.8F});  // merges with the first
  EXPECT_EQ(merge_similar_features(set, kMerging).size(), 4U);
}

TEST(MergeSimilarFeatures, TheOneWithMostNeighboursStandsForAChain) {
  Rng rng(4);
  const Eigen::VectorXf d = random_descriptor(rng);
  FeatureSet set;
  for (const float x : {0.0F, 0.004F, 0.008F}) add_feature(set, {x, 0, 0}, d);
  const FeatureSet merged = merge_similar_features(set, kMerging);
  ASSERT_EQ(merged.size(), 1U);  // taken in order of index, 0 would absorb 4 mm and isolate 8 mm
  EXPECT_NEAR(merged.points[0].x(), 0.004, 1e-6);
}

TEST(MergeSimilarFeatures, WhatIsTakenStaysTaken) {
  Rng rng(4);
  const Eigen::VectorXf d = random_descriptor(rng);
  FeatureSet set;
  for (const float x : {0.0F, 0.004F, 0.008F, 0.012F, 0.016F}) add_feature(set, {x, 0, 0}, d);
  const FeatureSet merged = merge_similar_features(set, kMerging);
  ASSERT_EQ(merged.size(), 2U);
  EXPECT_NEAR(merged.points[0].x(), 0.004, 1e-6);  // mean of 0, 4 and 8 mm
  EXPECT_NEAR(merged.points[1].x(), 0.014, 1e-6);  // mean of the remaining 12 and 16 mm
}

TEST(MergeSimilarFeatures, SameBytesForAnyNumberOfThreads) {
  const FeatureSet set = make_repeated(200, 8, 5);
  const FeatureSet serial = merge_similar_features(set, kMerging, 1);
  ASSERT_LT(serial.size(), set.size());
  for (const int threads : {2, 3}) {
    const FeatureSet parallel = merge_similar_features(set, kMerging, threads);
    EXPECT_EQ(parallel.points, serial.points);
    EXPECT_EQ(parallel.normals, serial.normals);
    EXPECT_EQ(parallel.descriptors, serial.descriptors);
  }
}

TEST(MergeSimilarFeatures, DoesNothingWhenSwitchedOffOrEmpty) {
  const FeatureSet set = make_repeated(10, 3, 6);
  EXPECT_EQ(merge_similar_features(set, {}).descriptors, set.descriptors);
  EXPECT_EQ(merge_similar_features(FeatureSet{}, kMerging).size(), 0U);
  EXPECT_THROW((void)merge_similar_features(set, {.max_distance_m = -1, .max_descriptor_distance = 0.1}),
               std::invalid_argument);
  EXPECT_THROW((void)merge_similar_features(set, {.max_distance_m = 1, .max_descriptor_distance = 3}),
               std::invalid_argument);
}

}  // namespace
}  // namespace resight
