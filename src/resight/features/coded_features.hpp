// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "resight/features/feature_set.hpp"

namespace resight {

/// A FeatureSet whose descriptors take 8 bits a component: what a trained object keeps, in memory and in its file.
struct CodedFeatures {
  FeatureType type = FeatureType::kSift;
  int dimension = 0;  ///< 128 (SIFT) or 352 (SHOT).
  std::vector<Eigen::Vector3f> points;
  std::vector<Eigen::Vector3f> normals;  ///< Unit, as long as points.
  std::vector<std::uint8_t> codes;       ///< n x dimension, row by row, as of encode_descriptors().

  [[nodiscard]] std::size_t size() const { return points.size(); }
  [[nodiscard]] std::span<const std::uint8_t> code(std::size_t i) const {
    return std::span(codes).subspan(i * static_cast<std::size_t>(dimension), static_cast<std::size_t>(dimension));
  }
};

/// See encode_descriptors(). What decode() returned is encoded without loss.
[[nodiscard]] CodedFeatures encode(const FeatureSet& features);
[[nodiscard]] FeatureSet decode(const CodedFeatures& features);

/// Descriptors at 8 bits a component: each row is scaled so that its largest component becomes 255. The scale need not
/// be kept, because descriptors are of unit norm. `descriptors`: n x dimension, not negative, no row all zero
/// (otherwise std::invalid_argument).
[[nodiscard]] std::vector<std::uint8_t> encode_descriptors(std::span<const float> descriptors, int dimension);

/// The unit vectors along the coded rows. Rows of zeros stay zero (see has_zero_row()).
[[nodiscard]] std::vector<float> decode_descriptors(std::span<const std::uint8_t> codes, int dimension);

/// What the components of one coded row are multiplied with to give a unit vector; 0 for a row of zeros.
[[nodiscard]] float scale_of_code(std::span<const std::uint8_t> row);

/// True if a row holds only zeros: no direction, the mark of a damaged file.
[[nodiscard]] bool has_zero_row(std::span<const std::uint8_t> codes, int dimension);

}  // namespace resight
