// SPDX-License-Identifier: Apache-2.0
#include "resight/features/internal/interleaved_rows.hpp"

#include <gtest/gtest.h>

#include <utility>

namespace resight {
namespace {

using Matrix = InterleavedRows::Matrix;

TEST(InterleavedRows, GivesItsRowsBack) {
  const Matrix rows = Matrix::Random(19, 7);
  const InterleavedRows interleaved(rows);
  ASSERT_EQ(interleaved.size(), 19);
  for (Eigen::Index r = 0; r < rows.rows(); ++r) EXPECT_EQ(interleaved.row(r), rows.row(r)) << r;
}

// Every number of queries of one pass, and ranges that begin and end within groups.
TEST(InterleavedRows, ProductsAreThoseOfMatrices) {
  const Matrix rows = Matrix::Random(45, 13);
  const InterleavedRows interleaved(rows);
  Matrix products;
  for (Eigen::Index count = 1; count <= 19; ++count)
    for (const auto& [begin, end] : {std::pair{0, 45}, {3, 5}, {8, 16}, {7, 41}, {44, 45}}) {
      const Matrix queries = Matrix::Random(count, 13);
      interleaved.multiply(queries, begin, end, products);
      const Matrix expected = queries * rows.middleRows(begin, end - begin).transpose();
      const Matrix computed = products.middleCols(begin % InterleavedRows::kLanes, end - begin);
      EXPECT_LT((computed - expected).cwiseAbs().maxCoeff(), 1e-5F) << count << " queries, rows from " << begin;
    }
}

TEST(InterleavedRows, QueriesMayBePartOfAMatrix) {
  const Matrix rows = Matrix::Random(10, 4);
  const Matrix all = Matrix::Random(6, 9);
  Matrix products;
  InterleavedRows(rows).multiply(all.block(1, 2, 3, 4), 0, 10, products);
  const Matrix expected = all.block(1, 2, 3, 4) * rows.transpose();
  EXPECT_LT((products.leftCols(10) - expected).cwiseAbs().maxCoeff(), 1e-5F);
}

}  // namespace
}  // namespace resight
