// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "resight/core/options.hpp"
#include "resight/features/descriptor_rows.hpp"

namespace resight {

/// A nearest neighbour of a query descriptor.
struct DescriptorMatch {
  int index = -1;         ///< Row in the indexed set; -1 if none.
  float distance_sq = 0;  ///< Squared L2 distance.
};

enum class IndexSearch : std::uint8_t {
  kInvertedFile,  ///< The nearest cells of a k-means clustering. Approximate.
  kExact,         ///< All descriptors.
};

struct DescriptorIndexOptions {
  IndexSearch search = IndexSearch::kInvertedFile;
  std::optional<int> num_cells{};
  int num_probes = 32;
  int exact_below = 8192;
  std::optional<int> num_components{};
  std::uint64_t seed = 1;  ///< Of the initial cells.
  int num_threads = 1;     ///< For building and searching. Same bits for any value >= 1.
  void check() const { check_options("DescriptorIndexOptions", *this); }
};

inline void declare(OptionVisitor& v, DescriptorIndexOptions& o) {
  v.choice("search", o.search,
           {{"inverted_file", "in the nearest cells of a k-means clustering"}, {"exact", "among all descriptors"}},
           "How the nearest descriptors are found.", "Jegou et al. 2011 (inverted file)");
  v.only_if(o.search == IndexSearch::kInvertedFile, "search", "inverted_file", [&] {
    v.field("num_cells", o.num_cells, at_least(1), "Cells of the inverted file. off: about 4 sqrt(n).");
    v.field("num_probes", o.num_probes, at_least(1), "Cells searched per query. More: better recall, slower.");
    v.field("exact_below", o.exact_below, at_least(0), "Smaller sets are searched exactly.");
    v.field(
        "num_components", o.num_components, at_least(1),
        "Unit descriptors with at least twice as many components are first compared by this many principal components "
        "of the set, and only the best few in full. off: all are compared in full.");
  });
  v.seed(o.seed);
  v.num_threads(o.num_threads);
}

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
