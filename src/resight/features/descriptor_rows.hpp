// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace resight {

/// Rows of descriptors that are read one at a time: either a copy of floats, or codes owned by the caller, which take a
/// quarter of the memory and of the reading time.
class DescriptorRows {
 public:
  DescriptorRows() = default;
  /// Copies n x dimension floats in row-major order. Throws std::invalid_argument unless they are finite and fill whole
  /// rows.
  DescriptorRows(std::span<const float> values, int dimension);
  /// Rows of `dimension` bytes from encode_descriptors(). The caller must keep them alive.
  DescriptorRows(std::vector<const std::uint8_t*> codes, int dimension);

  [[nodiscard]] int dimension() const { return static_cast<int>(dimension_); }
  [[nodiscard]] std::size_t size() const { return codes_.empty() ? num_rows_of_values_ : codes_.size(); }
  /// Prefetches row i, which will be read soon. Rows are scattered in memory.
  void prefetch(std::size_t i) const;
  /// Writes row i (`dimension` floats) to `row`.
  void read(std::size_t i, float* row) const;

 private:
  std::size_t dimension_ = 0;
  std::size_t num_rows_of_values_ = 0;
  std::vector<float> values_;
  std::vector<const std::uint8_t*> codes_;
  std::vector<float> scales_;  // one per code
};

}  // namespace resight
