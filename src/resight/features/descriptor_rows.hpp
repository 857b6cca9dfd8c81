// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace resight {

/// Rows of descriptors that are read one at a time: a copy of floats, or codes that the caller keeps, which take a
/// quarter of the memory and of the time to read.
class DescriptorRows {
 public:
  DescriptorRows() = default;
  /// n x dimension floats, row by row; copied. std::invalid_argument unless they are finite and fill whole rows.
  DescriptorRows(std::span<const float> values, int dimension);
  /// Rows of `dimension` bytes, as of encode_descriptors(), kept by the caller as long as they are read.
  DescriptorRows(std::vector<const std::uint8_t*> codes, int dimension);

  [[nodiscard]] int dimension() const { return static_cast<int>(dimension_); }
  [[nodiscard]] std::size_t size() const { return codes_.empty() ? num_rows_of_values_ : codes_.size(); }
  /// Row i is read soon: rows lie anywhere in memory.
  void prefetch(std::size_t i) const;
  /// Writes row i, `dimension` floats.
  void read(std::size_t i, float* row) const;

 private:
  std::size_t dimension_ = 0;
  std::size_t num_rows_of_values_ = 0;
  std::vector<float> values_;
  std::vector<const std::uint8_t*> codes_;
  std::vector<float> scales_;  // of the codes
};

}  // namespace resight
