// SPDX-License-Identifier: Apache-2.0
#include "resight/features/descriptor_rows.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "resight/core/check.hpp"
#include "resight/features/coded_features.hpp"

namespace resight {
namespace {

std::size_t checked_dimension(int dimension) {
  check_positive("dimension", dimension);
  return static_cast<std::size_t>(dimension);
}

}  // namespace

DescriptorRows::DescriptorRows(std::span<const float> values, int dimension)
    : dimension_(checked_dimension(dimension)),
      num_rows_of_values_(values.size() / dimension_),
      values_(values.begin(), values.end()) {
  require(values.size() % dimension_ == 0, "descriptors: the number of values is not a multiple of the dimension");
  require(std::ranges::all_of(values, [](float x) { return std::isfinite(x); }), "descriptors: one is not finite");
}

DescriptorRows::DescriptorRows(std::vector<const std::uint8_t*> codes, int dimension)
    : dimension_(checked_dimension(dimension)), codes_(std::move(codes)) {
  scales_.reserve(codes_.size());
  for (const std::uint8_t* row : codes_) scales_.push_back(scale_of_code({row, dimension_}));
}

void DescriptorRows::prefetch(std::size_t i) const {
  if (codes_.empty()) return;
  constexpr std::size_t kCacheLine = 64;
  for (std::size_t d = 0; d < dimension_; d += kCacheLine) __builtin_prefetch(codes_[i] + d);
  __builtin_prefetch(codes_[i] + dimension_ - 1);  // A row may start anywhere in a cache line.
}

void DescriptorRows::read(std::size_t i, float* row) const {
  if (codes_.empty()) {
    std::copy_n(values_.data() + i * dimension_, dimension_, row);
    return;
  }
  const std::uint8_t* code = codes_[i];
  const float scale = scales_[i];
  for (std::size_t d = 0; d < dimension_; ++d) row[d] = static_cast<float>(code[d]) * scale;
}

}  // namespace resight
