// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "resight/geometry/rigid3.hpp"

namespace resight {

enum class FeatureType : std::uint8_t { kSift = 0, kShot = 1 };

/// Keypoints with descriptors, n of them, in one frame (that of the camera when extracted), metres. Objects keep theirs
/// as CodedFeatures.
struct FeatureSet {
  FeatureType type = FeatureType::kSift;
  int dimension = 0;  ///< 128 (SIFT) or 352 (SHOT).
  std::vector<Eigen::Vector3f> points;
  std::vector<Eigen::Vector3f> normals;  ///< Unit, as long as points.
  std::vector<float> descriptors;        ///< n x dimension, row by row, each of unit L2 norm, finite.

  [[nodiscard]] std::size_t size() const { return points.size(); }
  [[nodiscard]] std::span<const float> descriptor(std::size_t i) const {
    return std::span(descriptors).subspan(i * static_cast<std::size_t>(dimension), static_cast<std::size_t>(dimension));
  }
  void append(const FeatureSet& other);
};

/// The set in frame a: points moved, normals rotated, descriptors kept (both kinds do not change under rigid motion).
[[nodiscard]] FeatureSet transform(const Rigid3& a_from_b, FeatureSet features_in_b);

}  // namespace resight
