// SPDX-License-Identifier: Apache-2.0
#include "resight/features/feature_set.hpp"

#include "resight/core/check.hpp"

namespace resight {

void FeatureSet::append(const FeatureSet& other) {
  if (other.size() == 0) return;
  if (size() == 0) {
    *this = other;
    return;
  }
  require(type == other.type && dimension == other.dimension,
          "FeatureSet::append: the sets contain different descriptors");
  points.insert(points.end(), other.points.begin(), other.points.end());
  normals.insert(normals.end(), other.normals.begin(), other.normals.end());
  descriptors.insert(descriptors.end(), other.descriptors.begin(), other.descriptors.end());
}

FeatureSet transform(const Rigid3& a_from_b, FeatureSet features_in_b) {
  const Rigid3f motion(a_from_b);
  for (Eigen::Vector3f& p : features_in_b.points) p = motion * p;
  for (Eigen::Vector3f& n : features_in_b.normals) n = motion.rotation * n;
  return features_in_b;
}

}  // namespace resight
