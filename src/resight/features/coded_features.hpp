// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "resight/features/feature_set.hpp"

namespace resight {

/// A FeatureSet with 8 bits per descriptor component. Trained objects keep this form in memory and in their file.
struct CodedFeatures {
  FeatureType type = FeatureType::kSift;
  int dimension = 0;  ///< 128 (SIFT) or 352 (SHOT).
  std::vector<Eigen::Vector3f> points;
  std::vector<Eigen::Vector3f> normals;  ///< Unit, as long as points.
  std::vector<std::uint8_t> codes;       ///< n x dimension in row-major order, from encode_descriptors().

  [[nodiscard]] std::size_t size() const { return points.size(); }
  [[nodiscard]] std::span<const std::uint8_t> code(std::size_t i) const {
    return std::span(codes).subspan(i * static_cast<std::size_t>(dimension), static_cast<std::size_t>(dimension));
  }
};

/// Encodes the descriptors of a set; see encode_descriptors(). Lossless for the results of decode().
[[nodiscard]] CodedFeatures encode(const FeatureSet& features);
/// Decodes the descriptors of a set; see decode_descriptors().
[[nodiscard]] FeatureSet decode(const CodedFeatures& features);

/// Encodes descriptors with 8 bits per component. Each row is scaled so that its largest component becomes 255;
/// descriptors have unit norm, so the scale need not be stored. `descriptors` is n x dimension. Throws
/// std::invalid_argument if a component is negative or not finite, or a row is zero.
[[nodiscard]] std::vector<std::uint8_t> encode_descriptors(std::span<const float> descriptors, int dimension);

/// Decodes rows to unit vectors. Rows of zeros stay zero (see has_zero_row()).
[[nodiscard]] std::vector<float> decode_descriptors(std::span<const std::uint8_t> codes, int dimension);

/// Factor that scales a coded row to unit norm; 0 for a row of zeros.
[[nodiscard]] float scale_of_code(std::span<const std::uint8_t> row);

/// Whether a row contains only zeros and therefore has no direction. Occurs only in damaged files.
[[nodiscard]] bool has_zero_row(std::span<const std::uint8_t> codes, int dimension);

}  // namespace resight
