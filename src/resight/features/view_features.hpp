// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <vector>

#include "resight/features/descriptor_index.hpp"
#include "resight/features/feature_set.hpp"

namespace resight {

/// Features of one view with their index, for matching against other views. Camera frame.
class ViewFeatures {
 public:
  explicit ViewFeatures(FeatureSet features_in_camera);
  [[nodiscard]] const FeatureSet& features() const { return features_; }
  [[nodiscard]] const DescriptorIndex& index() const { return index_; }

 private:
  FeatureSet features_;
  DescriptorIndex index_;
};

/// Indices of two features that are each other's match.
struct FeaturePair {
  int a = -1;
  int b = -1;
};

/// Pairs of features that are the nearest of each other, both clearly nearer than the second nearest: the ratio of the
/// distances is less than `max_ratio` (Lowe 2004). In the order of a.
[[nodiscard]] std::vector<FeaturePair> find_mutual_matches(const ViewFeatures& a, const ViewFeatures& b,
                                                           double max_ratio);

}  // namespace resight
