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

constexpr Index kQueriesPerBlock = 128;   // of products with all centroids
constexpr Index kQueriesPerBatch = 1024;  // looked up together: the more, the more of them share the reading of a cell
constexpr std::size_t kNumParts = 8;      // of the rows, scanned in parallel; fixed, whatever the number of threads
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

// |c|^2 - 2 q.c of each centroid: its squared distance but for |q|^2, which does not change the order.
using Scores = Eigen::ArrayXf;

// Row of `centroids` nearest to each row of `data`.
std::vector<int> assign_to_cells(const Block& data, const Matrix& centroids, int num_threads) {
  const Scores norms_sq = centroids.rowwise().squaredNorm();
  std::vector<int> cell(static_cast<std::size_t>(data.rows()));
  parallel_for_blocks(cell.size(), kQueriesPerBlock, num_threads, [&](std::size_t begin, std::size_t end) {
    const auto rows = static_cast<Index>(end - begin);
    const Matrix products = data.middleRows(static_cast<Index>(begin), rows) * centroids.transpose();
    Scores scores(centroids.rows());
    for (Index r = 0; r < rows; ++r) {  // first the minimum, then its place: vector code, unlike minCoeff(&place)
      scores = norms_sq - 2.0F * products.row(r).transpose().array();
      const float lowest = scores.minCoeff();
      cell[begin + static_cast<std::size_t>(r)] =
          static_cast<int>(std::find(scores.begin(), scores.end(), lowest) - scores.begin());
    }
  });
  return cell;
}

// The `count` centroids of lowest score (ties: the lower index), in no order.
void find_nearest_cells(const Scores& scores, std::size_t count, std::vector<DescriptorMatch>& nearest) {
  nearest.clear();  // a heap, the farthest on top: nearly all centroids are dismissed by one comparison
  for (Index c = 0; c < scores.size(); ++c) {
    if (nearest.size() == count) {
      if (!(scores[c] < nearest.front().distance_sq)) continue;
      std::ranges::pop_heap(nearest, BestList::before);
      nearest.pop_back();
    }
    nearest.push_back({static_cast<int>(c), scores[c]});
    std::ranges::push_heap(nearest, BestList::before);
  }
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
  void scan(const Block& queries, std::span<const int> query_of_row, Index begin, Index end, BestList* best) const;
  void search_batch(const Block& queries, int k, DescriptorMatch* results) const;
  std::vector<std::vector<int>> probe_cells(const Block& queries) const;
  void scan_cells(const Block& queries, const std::vector<std::vector<int>>& queries_of_cell, std::size_t part,
                  BestList* best) const;
  void scan_rows(const Block& queries, std::size_t part, BestList* best) const;
  void settle(const Block& queries, Index q, int k, std::vector<BestList>& best, DescriptorMatch* results) const;

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

// Compares all `queries` with the rows [begin, end). query_of_row: which list each query fills.
void DescriptorIndex::Impl::scan(const Block& queries, std::span<const int> query_of_row, Index begin, Index end,
                                 BestList* best) const {
  for (Index first = begin; first < end; first += kRowsPerBlock) {
    const Index count = std::min(kRowsPerBlock, end - first);
    const Matrix products = queries * rows.middleRows(first, count).transpose();
    for (Index q = 0; q < queries.rows(); ++q) {
      BestList& list = best[query_of_row[static_cast<std::size_t>(q)]];
      for (Index r = 0; r < count; ++r) {
        const float score = norms_sq[first + r] - 2.0F * products(q, r);
        if (list.accepts(score)) list.add(static_cast<int>(first + r), score);
      }
    }
  }
}

// Which queries look into each cell.
std::vector<std::vector<int>> DescriptorIndex::Impl::probe_cells(const Block& queries) const {
  const auto num_cells = static_cast<std::size_t>(centroids.rows());
  const auto num_probes = std::min<std::size_t>(static_cast<std::size_t>(options.num_probes), num_cells);
  const auto num_queries = static_cast<std::size_t>(queries.rows());
  const Scores centroid_norms_sq = centroids.rowwise().squaredNorm();
  std::vector<int> probes(num_queries * num_probes);
  parallel_for_blocks(num_queries, kQueriesPerBlock, options.num_threads, [&](std::size_t begin, std::size_t end) {
    const auto first = static_cast<Index>(begin);
    const Matrix products = queries.middleRows(first, static_cast<Index>(end) - first) * centroids.transpose();
    Scores scores(centroids.rows());
    std::vector<DescriptorMatch> nearest;
    for (std::size_t q = begin; q < end; ++q) {
      scores = centroid_norms_sq - 2.0F * products.row(static_cast<Index>(q - begin)).transpose().array();
      find_nearest_cells(scores, num_probes, nearest);
      for (std::size_t p = 0; p < num_probes; ++p) probes[q * num_probes + p] = nearest[p].index;
    }
  });
  std::vector<std::vector<int>> queries_of_cell(num_cells);
  for (std::size_t i = 0; i < probes.size(); ++i)
    queries_of_cell[static_cast<std::size_t>(probes[i])].push_back(static_cast<int>(i / num_probes));
  return queries_of_cell;
}

// Every kNumParts-th cell: neighbouring cells of the k-means are unrelated, so the parts are about even.
void DescriptorIndex::Impl::scan_cells(const Block& queries, const std::vector<std::vector<int>>& queries_of_cell,
                                       std::size_t part, BestList* best) const {
  Matrix gathered;
  for (std::size_t c = part; c < queries_of_cell.size(); c += kNumParts) {
    const std::vector<int>& members = queries_of_cell[c];
    if (members.empty() || cell_begin[c] == cell_begin[c + 1]) continue;
    gathered.resize(static_cast<Index>(members.size()), queries.cols());
    for (std::size_t m = 0; m < members.size(); ++m) gathered.row(static_cast<Index>(m)) = queries.row(members[m]);
    scan(gathered, members, cell_begin[c], cell_begin[c + 1], best);
  }
}

void DescriptorIndex::Impl::scan_rows(const Block& queries, std::size_t part, BestList* best) const {
  std::vector<int> all(static_cast<std::size_t>(queries.rows()));
  std::iota(all.begin(), all.end(), 0);
  const auto begin_of = [&](std::size_t p) {
    return rows.rows() * static_cast<Index>(p) / static_cast<Index>(kNumParts);
  };
  scan(queries, all, begin_of(part), begin_of(part + 1), best);
}

// Brings the lists of all parts of a query together, and gives its best few their true distances.
void DescriptorIndex::Impl::settle(const Block& queries, Index q, int k, std::vector<BestList>& best,
                                   DescriptorMatch* results) const {
  BestList& merged = best[static_cast<std::size_t>(q)];
  for (std::size_t part = 1; part < kNumParts; ++part)
    for (const DescriptorMatch& entry :
         best[part * static_cast<std::size_t>(queries.rows()) + static_cast<std::size_t>(q)].entries())
      if (merged.accepts(entry.distance_sq)) merged.add(entry.index, entry.distance_sq);
  auto& entries = merged.entries();
  for (DescriptorMatch& entry : entries) {
    entry.distance_sq = (queries.row(q) - rows.row(entry.index)).squaredNorm();
    entry.index = original[static_cast<std::size_t>(entry.index)];
  }
  std::sort(entries.begin(), entries.end(), BestList::before);
  std::copy_n(entries.begin(), std::min(entries.size(), static_cast<std::size_t>(k)), results + q * k);
}

void DescriptorIndex::Impl::search_batch(const Block& queries, int k, DescriptorMatch* results) const {
  const auto num_queries = static_cast<std::size_t>(queries.rows());
  std::vector<BestList> best(kNumParts * num_queries, BestList(static_cast<std::size_t>(k + kSpareCandidates)));
  const bool has_cells = centroids.rows() > 0;
  const auto queries_of_cell = has_cells ? probe_cells(queries) : std::vector<std::vector<int>>();
  parallel_for(kNumParts, options.num_threads, [&](std::size_t part) {
    BestList* lists = best.data() + part * num_queries;
    if (has_cells)
      scan_cells(queries, queries_of_cell, part, lists);
    else
      scan_rows(queries, part, lists);
  });
  parallel_for_blocks(num_queries, kQueriesPerBlock, options.num_threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t q = begin; q < end; ++q) settle(queries, static_cast<Index>(q), k, best, results);
  });
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
  for (Index begin = 0; begin < num_queries; begin += kQueriesPerBatch)
    impl_->search_batch(all.middleRows(begin, std::min(kQueriesPerBatch, num_queries - begin)), k,
                        results.data() + begin * k);
  return results;
}

std::size_t DescriptorIndex::size() const { return static_cast<std::size_t>(impl_->rows.rows()); }

}  // namespace resight
