// SPDX-License-Identifier: Apache-2.0
#include "resight/features/internal/interleaved_rows.hpp"

#include <algorithm>
#include <array>

namespace resight {
namespace {

using Eigen::Index;
using Lanes = Eigen::Array<float, InterleavedRows::kLanes, 1>;

constexpr Index kMaxQueries = 8;  // Of one pass: their sums stay in registers.

// Products of `Count` successive queries with one group. Up to three queries have four partial sums each, because an
// addition to a sum waits for the one before.
template <Index Count>
void multiply_group(const float* query, Index query_stride, const float* group, Index dimension, float* product,
                    Index product_stride) {
  constexpr Index kParts = Count < 4 ? 4 : 1;
  std::array<std::array<Lanes, Count>, kParts> sums;
  for (auto& part : sums) part.fill(Lanes::Zero());
  const auto add = [&](std::array<Lanes, Count>& part, Index d) {
    const Lanes values = Eigen::Map<const Lanes>(group + d * InterleavedRows::kLanes);
    for (Index q = 0; q < Count; ++q) part[static_cast<std::size_t>(q)] += query[q * query_stride + d] * values;
  };
  Index d = 0;
  for (; d + kParts <= dimension; d += kParts)
    for (Index p = 0; p < kParts; ++p) add(sums[static_cast<std::size_t>(p)], d + p);
  for (; d < dimension; ++d) add(sums[0], d);
  for (std::size_t q = 0; q < Count; ++q) {
    for (std::size_t p = 1; p < kParts; ++p) sums[0][q] += sums[p][q];
    Eigen::Map<Lanes>(product + static_cast<Index>(q) * product_stride) = sums[0][q];
  }
}

using Kernel = decltype(&multiply_group<1>);
constexpr std::array<Kernel, kMaxQueries + 1> kKernels = {nullptr,           multiply_group<1>, multiply_group<2>,
                                                          multiply_group<3>, multiply_group<4>, multiply_group<5>,
                                                          multiply_group<6>, multiply_group<7>, multiply_group<8>};

}  // namespace

InterleavedRows::InterleavedRows(const Matrix& rows) : size_(rows.rows()), dimension_(rows.cols()) {
  const Index num_groups = (size_ + kLanes - 1) / kLanes;
  values_.assign(static_cast<std::size_t>(num_groups * kLanes * dimension_), 0.0F);
  for (Index r = 0; r < size_; ++r) {
    float* const first = values_.data() + r / kLanes * kLanes * dimension_ + r % kLanes;
    for (Index d = 0; d < dimension_; ++d) first[d * kLanes] = rows(r, d);
  }
}

Eigen::RowVectorXf InterleavedRows::row(Index index) const {
  const float* const first = group(index / kLanes) + index % kLanes;
  return Eigen::Map<const Eigen::RowVectorXf, 0, Eigen::InnerStride<kLanes>>(first, dimension_);
}

void InterleavedRows::multiply(const Block& queries, Index begin, Index end, Matrix& products) const {
  const Index first_group = begin / kLanes;
  const Index num_groups = (end + kLanes - 1) / kLanes - first_group;
  products.resize(queries.rows(), num_groups * kLanes);
  for (Index g = 0; g < num_groups; ++g)
    for (Index q = 0; q < queries.rows(); q += kMaxQueries) {
      const auto count = static_cast<std::size_t>(std::min(kMaxQueries, queries.rows() - q));
      kKernels[count](queries.data() + q * queries.outerStride(), queries.outerStride(), group(first_group + g),
                      dimension_, &products(q, g * kLanes), products.cols());
    }
}

}  // namespace resight
