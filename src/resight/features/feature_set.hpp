// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "resight/geometry/rigid3.hpp"

namespace resight {

/// Kind of a feature descriptor.
enum class FeatureType : std::uint8_t { kSift = 0, kShot = 1 };

/// n keypoints with descriptors in one frame (that of the camera after extraction), metres. Trained objects store
/// CodedFeatures instead.
struct FeatureSet {
  FeatureType type = FeatureType::kSift;
  int dimension = 0;  ///< 128 (SIFT) or 352 (SHOT).
  std::vector<Eigen::Vector3f> points;
  std::vector<Eigen::Vector3f> normals;  ///< Unit, as long as points.
  std::vector<float> descriptors;        ///< n x dimension in row-major order. Rows are finite and have unit L2 norm.

  [[nodiscard]] std::size_t size() const { return points.size(); }
  [[nodiscard]] std::span<const float> descriptor(std::size_t i) const {
    return std::span(descriptors).subspan(i * static_cast<std::size_t>(dimension), static_cast<std::size_t>(dimension));
  }
  /// Appends the features of `other`. Both sets must have the same type and dimension, unless one is empty.
  void append(const FeatureSet& other);
};

/// Transforms the set to frame a. Moves points, rotates normals and keeps descriptors, which are invariant to rigid
/// motion.
[[nodiscard]] FeatureSet transform(const Rigid3& a_from_b, FeatureSet features_in_b);

}  // namespace resight
