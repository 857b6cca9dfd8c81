// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <vector>

namespace resight {

/// Rows of a matrix in groups of eight, value by value, so that one vector instruction advances the products of a query
/// with eight rows. A general product of matrices first copies its factors into such an order, which does not pay for a
/// few queries.
class InterleavedRows {
 public:
  using Matrix = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  using Block = Eigen::Ref<const Matrix, 0, Eigen::OuterStride<>>;
  static constexpr Eigen::Index kLanes = 8;

  InterleavedRows() = default;
  explicit InterleavedRows(const Matrix& rows);

  [[nodiscard]] Eigen::Index size() const { return size_; }
  [[nodiscard]] Eigen::RowVectorXf row(Eigen::Index index) const;

  /// The products of all queries with the rows [begin, end), a query per row of `products`. The first of them is in
  /// the column `begin` % kLanes: products are computed for whole groups.
  void multiply(const Block& queries, Eigen::Index begin, Eigen::Index end, Matrix& products) const;

 private:
  [[nodiscard]] const float* group(Eigen::Index g) const { return values_.data() + g * kLanes * dimension_; }

  Eigen::Index size_ = 0;
  Eigen::Index dimension_ = 0;
  std::vector<float> values_;  // Groups x dimension x lanes; zero after the last row.
};

}  // namespace resight
