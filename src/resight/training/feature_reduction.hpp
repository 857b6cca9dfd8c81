// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "resight/features/feature_set.hpp"

namespace resight {

/// When two features of an object count as one seen twice.
struct FeatureMerging {
  double max_distance_m = 0;           ///< Between their points; 0 = nothing is merged.
  double max_descriptor_distance = 0;  ///< L2 between the unit descriptors.
  void check() const;
};

/// Merges what neighbouring training views repeat: each feature that has not been taken yet, those with most neighbours
/// first (ties: lower index), takes all its remaining neighbours (near in space and in descriptor, normals within 60
/// deg: the two sides of a thin wall stay apart) and stands for them with their mean point, normal and descriptor,
/// renormalised. In order of the lowest index of each group. Same bytes for any `num_threads` >= 1.
[[nodiscard]] FeatureSet merge_similar_features(const FeatureSet& features, const FeatureMerging& merging,
                                                int num_threads = 1);

}  // namespace resight
