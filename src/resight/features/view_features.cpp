// SPDX-License-Identifier: Apache-2.0
#include "resight/features/view_features.hpp"

#include <utility>

namespace resight {
namespace {

// For each feature of `queries`, the nearest of `index` if it passes the ratio test; otherwise -1.
std::vector<int> find_distinct(const FeatureSet& queries, const DescriptorIndex& index, double max_ratio) {
  const std::vector<DescriptorMatch> matches = index.search(queries.descriptors, 2);
  const double max_ratio_sq = max_ratio * max_ratio;
  std::vector<int> nearest(queries.size(), -1);
  for (std::size_t i = 0; i < nearest.size(); ++i) {
    const DescriptorMatch& best = matches[2 * i];
    const DescriptorMatch& next = matches[2 * i + 1];
    if (next.index >= 0 && best.distance_sq < max_ratio_sq * next.distance_sq) nearest[i] = best.index;
  }
  return nearest;
}

}  // namespace

ViewFeatures::ViewFeatures(FeatureSet features_in_camera)
    : features_(std::move(features_in_camera)),
      index_(features_.descriptors, features_.dimension, {.exact_below = 1 << 20}) {}

std::vector<FeaturePair> find_mutual_matches(const ViewFeatures& a, const ViewFeatures& b, double max_ratio) {
  const std::vector<int> b_of_a = find_distinct(a.features(), b.index(), max_ratio);
  const std::vector<int> a_of_b = find_distinct(b.features(), a.index(), max_ratio);
  std::vector<FeaturePair> pairs;
  for (std::size_t i = 0; i < b_of_a.size(); ++i) {
    const auto in_a = static_cast<int>(i);
    if (b_of_a[i] >= 0 && a_of_b[static_cast<std::size_t>(b_of_a[i])] == in_a) pairs.push_back({in_a, b_of_a[i]});
  }
  return pairs;
}

}  // namespace resight
