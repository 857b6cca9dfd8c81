// SPDX-License-Identifier: Apache-2.0
#include "resight/features/descriptor_index.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <numeric>

#include "resight/core/check.hpp"
#include "resight/core/parallel.hpp"
#include "resight/core/random.hpp"

namespace resight {
namespace {

using Matrix = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
using Block = Eigen::Ref<const Matrix, 0, Eigen::OuterStride<>>;
using Eigen::Index;

constexpr Index kQueriesPerBlock = 256;  // with a block of rows in the second level cache
constexpr Index kRowsPerBlock = 1024;
constexpr int kSamplesPerCell = 24;  // of the k-means: more changes recall by less than its noise
constexpr int kMeansIterations = 5;
constexpr int kSpareCandidates = 4;  // the products round: the exact order is settled among a few more than k

// The best few of a query, in the strict order (distance, index): the result does not depend on the order of arrival.
class BestList {
 public:
  explicit BestList(std::size_t capacity) : capacity_(capacity) { entries_.reserve(capacity + 1); }
  [[nodiscard]] bool accepts(float distance_sq) const {
    return entries_.size() < capacity_ || distance_sq <= entries_.back().distance_sq;
  }
  void add(int index, float distance_sq) {
    const DescriptorMatch entry{index, distance_sq};
    entries_.insert(std::upper_bound(entries_.begin(), entries_.end(), entry, before), entry);
    if (entries_.size() > capacity_) entries_.pop_back();
  }
  [[nodiscard]] std::vector<DescriptorMatch>& entries() { return entries_; }
  static bool before(const DescriptorMatch& a, const DescriptorMatch& b) {
    return a.distance_sq != b.distance_sq ? a.distance_sq < b.distance_sq : a.index < b.index;
  }

 private:
  std::size_t capacity_;
  std::vector<DescriptorMatch> entries_;
};

// Row of `centroids` nearest to each row of `data`.
std::vector<int> assign_to_cells(const Block& data, const Matrix& centroids, int num_threads) {
  const Eigen::VectorXf norms_sq = centroids.rowwise().squaredNorm();
  std::vector<int> cell(static_cast<std::size_t>(data.rows()));
  parallel_for_blocks(cell.size(), kQueriesPerBlock, num_threads, [&](std::size_t begin, std::size_t end) {
    const auto rows = static_cast<Index>(end - begin);
    const Matrix products = data.middleRows(static_cast<Index>(begin), rows) * centroids.transpose();
    for (Index r = 0; r < rows; ++r) {
      Index best = 0;
      (norms_sq.transpose() - 2.0F * products.row(r)).minCoeff(&best);
      cell[begin + static_cast<std::size_t>(r)] = static_cast<int>(best);
    }
  });
  return cell;
}

// Lloyd's iterations on a seeded sample. A cell that runs empty keeps its centroid.
Matrix cluster_cells(const Block& data, int num_cells, const DescriptorIndexOptions& options) {
  std::vector<int> order(static_cast<std::size_t>(data.rows()));
  std::iota(order.begin(), order.end(), 0);
  Rng rng(options.seed);
  rng.shuffle(order);
  const Index num_samples = std::min<Index>(data.rows(), static_cast<Index>(num_cells) * kSamplesPerCell);
  Matrix sample(num_samples, data.cols());
  for (Index i = 0; i < num_samples; ++i) sample.row(i) = data.row(order[static_cast<std::size_t>(i)]);
  Matrix centroids = sample.topRows(num_cells);
  for (int iteration = 0; iteration < kMeansIterations; ++iteration) {
    const std::vector<int> cell = assign_to_cells(sample, centroids, options.num_threads);
    Matrix sums = Matrix::Zero(num_cells, data.cols());
    std::vector<int> counts(static_cast<std::size_t>(num_cells), 0);
    for (Index i = 0; i < num_samples; ++i) {
      sums.row(cell[static_cast<std::size_t>(i)]) += sample.row(i);
      ++counts[static_cast<std::size_t>(cell[static_cast<std::size_t>(i)])];
    }
    for (Index c = 0; c < num_cells; ++c)
      if (const int count = counts[static_cast<std::size_t>(c)]; count > 0)
        centroids.row(c) = sums.row(c) / static_cast<float>(count);
  }
  return centroids;
}

}  // namespace

void DescriptorIndexOptions::check() const {
  check_not_negative("DescriptorIndexOptions.num_cells", num_cells);
  check_positive("DescriptorIndexOptions.num_probes", num_probes);
  check_not_negative("DescriptorIndexOptions.exact_below", exact_below);
  check_positive("DescriptorIndexOptions.num_threads", num_threads);
}

struct DescriptorIndex::Impl {
  Impl(std::span<const float> descriptors, int dimension, const DescriptorIndexOptions& settings);
  void build_cells(const Block& data, int num_cells);
  void scan(const Block& queries, std::span<const int> query_of_row, Index begin, Index end,
            std::vector<BestList>& best) const;
  void search_block(const Block& queries, int k, DescriptorMatch* results) const;
  void probe_cells(const Block& queries, std::vector<BestList>& best) const;

  DescriptorIndexOptions options;
  Matrix rows;                    // the descriptors, sorted by cell
  std::vector<int> original;      // index of each row in the caller's order
  Eigen::VectorXf norms_sq;       // of the rows
  Matrix centroids;               // empty: exact search
  std::vector<Index> cell_begin;  // first row of each cell, and the end
};

DescriptorIndex::Impl::Impl(std::span<const float> descriptors, int dimension, const DescriptorIndexOptions& settings)
    : options(settings) {
  const auto n = static_cast<Index>(descriptors.size()) / dimension;
  const Eigen::Map<const Matrix> data(descriptors.data(), n, dimension);
  const int automatic = static_cast<int>(4 * std::sqrt(static_cast<double>(n)));
  const int num_cells = std::min<int>(options.num_cells > 0 ? options.num_cells : automatic, static_cast<int>(n));
  if (n < options.exact_below || num_cells <= 1) {
    rows = data;
    original.resize(static_cast<std::size_t>(n));
    std::iota(original.begin(), original.end(), 0);
  } else {
    build_cells(data, num_cells);
  }
  norms_sq = rows.rowwise().squaredNorm();
}

void DescriptorIndex::Impl::build_cells(const Block& data, int num_cells) {
  centroids = cluster_cells(data, num_cells, options);
  const std::vector<int> cell = assign_to_cells(data, centroids, options.num_threads);
  cell_begin.assign(static_cast<std::size_t>(num_cells) + 1, 0);
  for (const int c : cell) ++cell_begin[static_cast<std::size_t>(c) + 1];
  std::partial_sum(cell_begin.begin(), cell_begin.end(), cell_begin.begin());
  std::vector<Index> next(cell_begin.begin(), cell_begin.end() - 1);
  rows.resize(data.rows(), data.cols());
  original.resize(cell.size());
  for (std::size_t i = 0; i < cell.size(); ++i) {
    const Index row = next[static_cast<std::size_t>(cell[i])]++;
    rows.row(row) = data.row(static_cast<Index>(i));
    original[static_cast<std::size_t>(row)] = static_cast<int>(i);
  }
}

// Compares all `queries` with the rows [begin, end). query_of_row: which list each query fills; |q|^2 is left out, as
// it does not change the order.
void DescriptorIndex::Impl::scan(const Block& queries, std::span<const int> query_of_row, Index begin, Index end,
                                 std::vector<BestList>& best) const {
  for (Index first = begin; first < end; first += kRowsPerBlock) {
    const Index count = std::min(kRowsPerBlock, end - first);
    const Matrix products = queries * rows.middleRows(first, count).transpose();
    for (Index q = 0; q < queries.rows(); ++q) {
      BestList& list = best[static_cast<std::size_t>(query_of_row[static_cast<std::size_t>(q)])];
      for (Index r = 0; r < count; ++r) {
        const float score = norms_sq[first + r] - 2.0F * products(q, r);
        if (list.accepts(score)) list.add(static_cast<int>(first + r), score);
      }
    }
  }
}

// The queries of a block, grouped by the cells they look into: each cell is read once a block.
void DescriptorIndex::Impl::probe_cells(const Block& queries, std::vector<BestList>& best) const {
  const auto num_cells = static_cast<std::size_t>(centroids.rows());
  const auto num_probes = std::min<std::size_t>(static_cast<std::size_t>(options.num_probes), num_cells);
  const Eigen::VectorXf centroid_norms_sq = centroids.rowwise().squaredNorm();
  const Matrix products = queries * centroids.transpose();
  std::vector<std::vector<int>> queries_of_cell(num_cells);
  std::vector<DescriptorMatch> ranked(num_cells);
  for (Index q = 0; q < queries.rows(); ++q) {
    for (std::size_t c = 0; c < num_cells; ++c) {
      const auto column = static_cast<Index>(c);
      ranked[c] = {static_cast<int>(c), centroid_norms_sq[column] - 2.0F * products(q, column)};
    }
    std::nth_element(ranked.begin(), ranked.begin() + static_cast<std::ptrdiff_t>(num_probes - 1), ranked.end(),
                     BestList::before);
    for (std::size_t p = 0; p < num_probes; ++p)
      queries_of_cell[static_cast<std::size_t>(ranked[p].index)].push_back(static_cast<int>(q));
  }
  Matrix gathered;
  for (std::size_t c = 0; c < num_cells; ++c) {
    const std::vector<int>& members = queries_of_cell[c];
    if (members.empty() || cell_begin[c] == cell_begin[c + 1]) continue;
    gathered.resize(static_cast<Index>(members.size()), queries.cols());
    for (std::size_t m = 0; m < members.size(); ++m) gathered.row(static_cast<Index>(m)) = queries.row(members[m]);
    scan(gathered, members, cell_begin[c], cell_begin[c + 1], best);
  }
}

void DescriptorIndex::Impl::search_block(const Block& queries, int k, DescriptorMatch* results) const {
  std::vector<BestList> best(static_cast<std::size_t>(queries.rows()),
                             BestList(static_cast<std::size_t>(k + kSpareCandidates)));
  if (centroids.rows() == 0) {
    std::vector<int> all(best.size());
    std::iota(all.begin(), all.end(), 0);
    scan(queries, all, 0, rows.rows(), best);
  } else {
    probe_cells(queries, best);
  }
  for (Index q = 0; q < queries.rows(); ++q) {
    auto& entries = best[static_cast<std::size_t>(q)].entries();
    for (DescriptorMatch& entry : entries) {
      entry.distance_sq = (queries.row(q) - rows.row(entry.index)).squaredNorm();
      entry.index = original[static_cast<std::size_t>(entry.index)];
    }
    std::sort(entries.begin(), entries.end(), BestList::before);
    const auto count = std::min(entries.size(), static_cast<std::size_t>(k));
    std::copy_n(entries.begin(), count, results + q * k);
  }
}

DescriptorIndex::DescriptorIndex(std::span<const float> descriptors, int dimension,
                                 const DescriptorIndexOptions& options) {
  options.check();
  check_positive("dimension", dimension);
  require(descriptors.size() % static_cast<std::size_t>(dimension) == 0,
          "DescriptorIndex: the number of values is not a multiple of the dimension");
  require(std::all_of(descriptors.begin(), descriptors.end(), [](float x) { return std::isfinite(x); }),
          "DescriptorIndex: a descriptor is not finite");
  impl_ = std::make_unique<Impl>(descriptors, dimension, options);
}
DescriptorIndex::~DescriptorIndex() = default;
DescriptorIndex::DescriptorIndex(DescriptorIndex&&) noexcept = default;
DescriptorIndex& DescriptorIndex::operator=(DescriptorIndex&&) noexcept = default;

std::vector<DescriptorMatch> DescriptorIndex::search(std::span<const float> queries, int k) const {
  check_positive("k", k);
  const Index dimension = impl_->rows.cols();
  require(queries.size() % static_cast<std::size_t>(dimension) == 0,
          "DescriptorIndex::search: the number of values is not a multiple of the dimension");
  require(std::all_of(queries.begin(), queries.end(), [](float x) { return std::isfinite(x); }),
          "DescriptorIndex::search: a query is not finite");
  const auto num_queries = static_cast<Index>(queries.size()) / dimension;
  const Eigen::Map<const Matrix> all(queries.data(), num_queries, dimension);
  std::vector<DescriptorMatch> results(static_cast<std::size_t>(num_queries * k));
  parallel_for_blocks(static_cast<std::size_t>(num_queries), kQueriesPerBlock, impl_->options.num_threads,
                      [&](std::size_t begin, std::size_t end) {
                        impl_->search_block(all.middleRows(static_cast<Index>(begin), static_cast<Index>(end - begin)),
                                            k, results.data() + begin * static_cast<std::size_t>(k));
                      });
  return results;
}

std::size_t DescriptorIndex::size() const { return static_cast<std::size_t>(impl_->rows.rows()); }

}  // namespace resight
