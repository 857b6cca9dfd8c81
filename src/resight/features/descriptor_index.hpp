// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "resight/features/descriptor_rows.hpp"

namespace resight {

/// A found descriptor.
struct DescriptorMatch {
  int index = -1;         ///< Row of the indexed set; -1 = none.
  float distance_sq = 0;  ///< Squared L2.
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

/// k nearest neighbours among descriptors: exact for small sets, else an inverted file over k-means cells (IVF-flat),
/// if wanted of principal components. Deterministic.
class DescriptorIndex {
 public:
  /// n x dimension floats, row by row; copied. n = 0 gives an index that finds nothing.
  DescriptorIndex(std::span<const float> descriptors, int dimension, const DescriptorIndexOptions& options = {});
  explicit DescriptorIndex(DescriptorRows descriptors, const DescriptorIndexOptions& options = {});
  ~DescriptorIndex();
  DescriptorIndex(DescriptorIndex&&) noexcept;
  DescriptorIndex& operator=(DescriptorIndex&&) noexcept;

  /// For each query (m x dimension) `k` matches, nearest first (ties: lower index); index -1 fills up. m x k results.
  [[nodiscard]] std::vector<DescriptorMatch> search(std::span<const float> queries, int k) const;
  [[nodiscard]] std::size_t size() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace resight
