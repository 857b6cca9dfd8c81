// SPDX-License-Identifier: Apache-2.0
#include "resight/features/coded_features.hpp"

#include <algorithm>
#include <cmath>

#include "resight/core/check.hpp"

namespace resight {
namespace {

std::size_t count_rows(std::size_t size, int dimension) {
  require(dimension > 0 || size == 0, "descriptors need a dimension > 0");
  if (size == 0) return 0;
  require(size % static_cast<std::size_t>(dimension) == 0, "descriptors do not fill whole rows");
  return size / static_cast<std::size_t>(dimension);
}

std::uint32_t sum_of_squares(std::span<const std::uint8_t> row) {
  std::uint32_t sum = 0;
  for (const std::uint8_t c : row) sum += static_cast<std::uint32_t>(c) * c;
  return sum;
}

}  // namespace

std::vector<std::uint8_t> encode_descriptors(std::span<const float> descriptors, int dimension) {
  const std::size_t rows = count_rows(descriptors.size(), dimension);
  std::vector<std::uint8_t> codes(descriptors.size());
  for (std::size_t r = 0; r < rows; ++r) {
    const std::size_t begin = r * static_cast<std::size_t>(dimension);
    const std::span<const float> row = descriptors.subspan(begin, static_cast<std::size_t>(dimension));
    // Each value by itself: a maximum may lose a NaN.
    const bool is_sound = std::ranges::all_of(row, [](float x) { return x >= 0 && std::isfinite(x); });
    const float high = is_sound ? std::ranges::max(row) : 0;
    require(high > 0, "descriptors must be finite, not negative and not zero");
    const float scale = 255.0F / high;
    for (std::size_t i = 0; i < row.size(); ++i) codes[begin + i] = static_cast<std::uint8_t>(row[i] * scale + 0.5F);
  }
  return codes;
}

float scale_of_code(std::span<const std::uint8_t> row) {
  const std::uint32_t norm_sq = sum_of_squares(row);
  return norm_sq == 0 ? 0.0F : static_cast<float>(1.0 / std::sqrt(static_cast<double>(norm_sq)));
}

std::vector<float> decode_descriptors(std::span<const std::uint8_t> codes, int dimension) {
  const std::size_t rows = count_rows(codes.size(), dimension);
  std::vector<float> descriptors(codes.size());
  for (std::size_t r = 0; r < rows; ++r) {
    const std::size_t begin = r * static_cast<std::size_t>(dimension);
    const std::span<const std::uint8_t> row = codes.subspan(begin, static_cast<std::size_t>(dimension));
    const float scale = scale_of_code(row);
    for (std::size_t i = 0; i < row.size(); ++i) descriptors[begin + i] = static_cast<float>(row[i]) * scale;
  }
  return descriptors;
}

bool has_zero_row(std::span<const std::uint8_t> codes, int dimension) {
  const std::size_t rows = count_rows(codes.size(), dimension);
  for (std::size_t r = 0; r < rows; ++r)
    if (sum_of_squares(codes.subspan(r * static_cast<std::size_t>(dimension), static_cast<std::size_t>(dimension))) ==
        0)
      return true;
  return false;
}

CodedFeatures encode(const FeatureSet& features) {
  return {.type = features.type,
          .dimension = features.dimension,
          .points = features.points,
          .normals = features.normals,
          .codes = encode_descriptors(features.descriptors, features.dimension)};
}

FeatureSet decode(const CodedFeatures& features) {
  return {.type = features.type,
          .dimension = features.dimension,
          .points = features.points,
          .normals = features.normals,
          .descriptors = decode_descriptors(features.codes, features.dimension)};
}

}  // namespace resight
