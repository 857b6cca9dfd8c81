// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "resight/core/options.hpp"
#include "resight/features/feature_set.hpp"

namespace resight {

/// Limits within which two features of an object count as one feature that was observed twice.
struct FeatureMerging {
  double max_distance_m = 0;
  double max_descriptor_distance = 0;
  void check() const { check_options("FeatureMerging", *this); }
};

inline void declare(OptionVisitor& v, FeatureMerging& o) {
  v.field("max_distance_m", o.max_distance_m, at_least(0), "Largest distance of their points. 0: nothing is merged.");
  v.field("max_descriptor_distance", o.max_descriptor_distance, between(0, 2),
          "Largest L2 distance of the unit descriptors.");
}

/// Merges features that adjacent training views repeat. Features are processed by falling number of neighbours (ties:
/// lower index). Each feature that is still free takes its free neighbours: features close in space and in descriptor
/// whose normals differ by less than 60 deg, so that both sides of a thin wall stay apart. The mean point, normal and
/// descriptor of the group, renormalised, replace its members. Groups are in order of their lowest index. Gives the
/// same bytes for any `num_threads` >= 1.
[[nodiscard]] FeatureSet merge_similar_features(const FeatureSet& features, const FeatureMerging& merging,
                                                int num_threads = 1);

}  // namespace resight
