// SPDX-License-Identifier: Apache-2.0
#include "resight/training/feature_reduction.hpp"

#include <algorithm>
#include <numeric>

#include "resight/core/parallel.hpp"
#include "resight/geometry/kd_tree.hpp"

namespace resight {
namespace {

constexpr float kMinNormalCosine = 0.5F;

float descriptor_distance_sq(std::span<const float> a, std::span<const float> b) {
  const Eigen::Index size = static_cast<Eigen::Index>(a.size());
  return (Eigen::Map<const Eigen::VectorXf>(a.data(), size) - Eigen::Map<const Eigen::VectorXf>(b.data(), size))
      .squaredNorm();
}

// For each feature, the similar features in ascending order.
std::vector<std::vector<int>> find_similar(const FeatureSet& features, const FeatureMerging& merging, int num_threads) {
  const KdTree tree(features.points);
  const auto max_descriptor_sq = static_cast<float>(merging.max_descriptor_distance * merging.max_descriptor_distance);
  std::vector<std::vector<int>> similar(features.size());
  parallel_for_blocks(features.size(), 64, num_threads, [&](std::size_t begin, std::size_t end) {
    std::vector<PointNeighbor> near;
    for (std::size_t i = begin; i < end; ++i) {
      tree.within(features.points[i], merging.max_distance_m, near);
      for (const PointNeighbor& n : near) {
        const auto j = static_cast<std::size_t>(n.index);
        if (j == i || features.normals[i].dot(features.normals[j]) < kMinNormalCosine) continue;
        if (descriptor_distance_sq(features.descriptor(i), features.descriptor(j)) <= max_descriptor_sq)
          similar[i].push_back(n.index);
      }
    }
  });
  return similar;
}

// Group number of each feature. Groups are in order of their lowest index.
std::vector<int> group_greedily(const std::vector<std::vector<int>>& similar) {
  std::vector<int> order(similar.size());
  std::iota(order.begin(), order.end(), 0);
  std::ranges::stable_sort(order, [&](int a, int b) { return similar[a].size() > similar[b].size(); });
  std::vector<int> representative(similar.size(), -1);
  for (const int i : order) {
    if (representative[i] >= 0) continue;
    representative[i] = i;
    for (const int j : similar[i])
      if (representative[j] < 0) representative[j] = i;
  }
  std::vector<int> number(similar.size(), -1);
  std::vector<int> groups(similar.size());
  int num_groups = 0;
  for (std::size_t i = 0; i < similar.size(); ++i) {
    int& n = number[representative[i]];
    if (n < 0) n = num_groups++;
    groups[i] = n;
  }
  return groups;
}

FeatureSet average_groups(const FeatureSet& features, const std::vector<int>& groups) {
  const auto num_groups = static_cast<std::size_t>(groups.empty() ? 0 : *std::ranges::max_element(groups) + 1);
  const auto dimension = static_cast<std::size_t>(features.dimension);
  FeatureSet merged{
      .type = features.type, .dimension = features.dimension, .points = {}, .normals = {}, .descriptors = {}};
  merged.points.assign(num_groups, Eigen::Vector3f::Zero());
  merged.normals.assign(num_groups, Eigen::Vector3f::Zero());
  merged.descriptors.assign(num_groups * dimension, 0.0F);
  std::vector<int> counts(num_groups, 0);
  const auto row = [&](std::size_t g) {
    return Eigen::Map<Eigen::VectorXf>(merged.descriptors.data() + g * dimension, features.dimension);
  };
  for (std::size_t i = 0; i < features.size(); ++i) {
    const auto g = static_cast<std::size_t>(groups[i]);
    merged.points[g] += features.points[i];
    merged.normals[g] += features.normals[i];
    row(g) += Eigen::Map<const Eigen::VectorXf>(features.descriptor(i).data(), features.dimension);
    ++counts[g];
  }
  for (std::size_t g = 0; g < num_groups; ++g) {
    merged.points[g] /= static_cast<float>(counts[g]);
    merged.normals[g].normalize();
    row(g).normalize();
  }
  return merged;
}

}  // namespace

FeatureSet merge_similar_features(const FeatureSet& features, const FeatureMerging& merging, int num_threads) {
  merging.check();
  if (merging.max_distance_m <= 0 || features.size() == 0) return features;
  return average_groups(features, group_greedily(find_similar(features, merging, num_threads)));
}

}  // namespace resight
