// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "resight/features/descriptor_rows.hpp"

namespace resight {

/// A nearest neighbour of a query descriptor.
struct DescriptorMatch {
  int index = -1;         ///< Row in the indexed set; -1 if none.
  float distance_sq = 0;  ///< Squared L2 distance.
};

struct DescriptorIndexOptions {
  int num_cells = 0;       ///< Of the inverted file; 0 = about 4 sqrt(n); 1 = exact search.
  int num_probes = 32;     ///< Cells looked into per query: recall against time.
  int exact_below = 8192;  ///< Smaller sets are searched exactly.
  int num_components = 0;  ///< Unit descriptors at least twice as long are looked for by so many principal components
                           ///< of the set, and only the best few compared whole; 0 = never.
  std::uint64_t seed = 1;  ///< Of the k-means start.
  int num_threads = 1;     ///< For building and searching. Same bits for any value >= 1.
  void check() const;
};

/// k nearest neighbours among descriptors. Search is exact for small sets, and otherwise uses an inverted file over
/// k-means cells (IVF-flat), optionally of principal components. Deterministic.
class DescriptorIndex {
 public:
  /// `descriptors`: n x dimension in row-major order; copied. An empty set gives an index that finds nothing.
  DescriptorIndex(std::span<const float> descriptors, int dimension, const DescriptorIndexOptions& options = {});
  explicit DescriptorIndex(DescriptorRows descriptors, const DescriptorIndexOptions& options = {});
  ~DescriptorIndex();
  DescriptorIndex(DescriptorIndex&&) noexcept;
  DescriptorIndex& operator=(DescriptorIndex&&) noexcept;

  /// Finds the `k` nearest descriptors of each query (m x dimension), nearest first (ties: lower index). Returns m x k
  /// matches; missing ones have index -1. Throws std::invalid_argument for a query that is not finite or an incomplete
  /// row.
  [[nodiscard]] std::vector<DescriptorMatch> search(std::span<const float> queries, int k) const;
  /// Number of indexed descriptors.
  [[nodiscard]] std::size_t size() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace resight
