// SPDX-License-Identifier: Apache-2.0
#include "resight/features/descriptor_index.hpp"

#include <Eigen/Core>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "resight/core/check.hpp"
#include "resight/core/parallel.hpp"
#include "resight/core/random.hpp"
#include "resight/features/internal/interleaved_rows.hpp"

namespace resight {
namespace {

using Matrix = InterleavedRows::Matrix;
using Block = InterleavedRows::Block;
using Eigen::Index;

constexpr Index kQueriesPerBlock = 128;  // Queries per product with all centroids.
// Queries that are processed together. In larger batches, more queries share the reading of a cell; more batches keep
// more threads busy.
constexpr std::size_t kMinBatch = 256;
constexpr std::size_t kMaxBatch = 2048;
constexpr std::size_t kWantedBatches = 8;
constexpr Index kRowsPerBlock = 1024;
constexpr int kSamplesPerCell = 24;  // Of the k-means sample. More change recall by less than its noise.
constexpr int kMeansIterations = 5;
// Candidates beyond k whose exact distances settle the order, since products are rounded.
constexpr int kSpareCandidates = 4;
constexpr int kSpareOfComponents = 16;  // Candidates beyond k that are compared whole after a search by components.
constexpr Index kSamplesOfComponents = 20000;  // Number of evenly spaced rows.
constexpr float kRounding = 1e-5F;             // Rounding error of a squared distance between unit vectors.

// The best candidates of a query in the strict order (distance, index). The result does not depend on the order of
// arrival.
class BestList {
 public:
  explicit BestList(std::size_t capacity) : capacity_(capacity) { entries_.reserve(capacity + 1); }
  void clear() { entries_.clear(); }
  [[nodiscard]] bool accepts(float distance_sq) const {
    return entries_.size() < capacity_ || distance_sq <= entries_.back().distance_sq;
  }
  void add(int index, float distance_sq) {
    const DescriptorMatch entry{index, distance_sq};
    entries_.insert(std::upper_bound(entries_.begin(), entries_.end(), entry, before), entry);
    if (entries_.size() > capacity_) entries_.pop_back();
  }
  [[nodiscard]] const std::vector<DescriptorMatch>& entries() const { return entries_; }
  static bool before(const DescriptorMatch& a, const DescriptorMatch& b) {
    return a.distance_sq != b.distance_sq ? a.distance_sq < b.distance_sq : a.index < b.index;
  }

 private:
  std::size_t capacity_;
  std::vector<DescriptorMatch> entries_;
};

// |c|^2 - 2 q.c of each centroid: its squared distance without |q|^2, which does not affect the order.
using Scores = Eigen::ArrayXf;

// Index of the centroid nearest to each row of `data`.
std::vector<int> assign_to_cells(const Block& data, const Matrix& centroids, int num_threads) {
  const Scores norms_sq = centroids.rowwise().squaredNorm();
  std::vector<int> cell(static_cast<std::size_t>(data.rows()));
  parallel_for_blocks(cell.size(), kQueriesPerBlock, num_threads, [&](std::size_t begin, std::size_t end) {
    const auto rows = static_cast<Index>(end - begin);
    const Matrix products = data.middleRows(static_cast<Index>(begin), rows) * centroids.transpose();
    Scores scores(centroids.rows());
    // Finds the minimum first, then its place: this vectorises, unlike minCoeff(&place).
    for (Index r = 0; r < rows; ++r) {
      scores = norms_sq - 2.0F * products.row(r).transpose().array();
      const float lowest = scores.minCoeff();
      cell[begin + static_cast<std::size_t>(r)] =
          static_cast<int>(std::find(scores.begin(), scores.end(), lowest) - scores.begin());
    }
  });
  return cell;
}

// The `count` centroids with the lowest scores (ties: lower index), in arbitrary order.
void find_nearest_cells(const Scores& scores, std::size_t count, std::vector<DescriptorMatch>& nearest) {
  nearest.clear();  // A heap with the farthest on top: one comparison dismisses nearly every centroid.
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

// Lloyd's iterations on a seeded sample. An empty cell keeps its centroid.
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

// Queries that visit each cell: queries[begin[c]] to queries[begin[c + 1] - 1] visit cell c.
struct Probes {
  std::vector<int> queries;
  std::vector<std::size_t> begin;
  [[nodiscard]] std::span<const int> queries_of(std::size_t c) const {
    return std::span(queries).subspan(begin[c], begin[c + 1] - begin[c]);
  }
};

// Groups queries by cell. `cell_of_probe` contains `num_probes` cells per query, in order of the queries.
Probes sort_by_cell(const std::vector<int>& cell_of_probe, std::size_t num_probes, std::size_t num_cells) {
  Probes probes;
  probes.begin.assign(num_cells + 1, 0);
  for (const int c : cell_of_probe) ++probes.begin[static_cast<std::size_t>(c) + 1];
  std::partial_sum(probes.begin.begin(), probes.begin.end(), probes.begin.begin());
  std::vector<std::size_t> next(probes.begin.begin(), probes.begin.end() - 1);
  probes.queries.resize(cell_of_probe.size());
  for (std::size_t i = 0; i < cell_of_probe.size(); ++i)
    probes.queries[next[static_cast<std::size_t>(cell_of_probe[i])]++] = static_cast<int>(i / num_probes);
  return probes;
}

// Reads `count` rows of `all`: first, first + step, ...
Matrix read_rows(const DescriptorRows& all, Index first, Index count, Index step = 1) {
  Matrix rows(count, all.dimension());
  for (Index i = 0; i < count; ++i) all.read(static_cast<std::size_t>(first + i * step), rows.row(i).data());
  return rows;
}

// Processes blocks, so that only part of the rows is held as floats at a time.
Eigen::RowVectorXf mean_of(const DescriptorRows& all) {
  const auto n = static_cast<Index>(all.size());
  Eigen::RowVectorXd sum = Eigen::RowVectorXd::Zero(all.dimension());
  for (Index first = 0; first < n; first += kRowsPerBlock)
    sum += read_rows(all, first, std::min(kRowsPerBlock, n - first)).colwise().sum().cast<double>();
  return (sum / static_cast<double>(n)).cast<float>();
}

// The directions of largest variance, as columns.
Matrix principal_components(const DescriptorRows& all, const Eigen::RowVectorXf& mean, Index count) {
  const auto n = static_cast<Index>(all.size());
  const Index step = std::max<Index>(1, n / kSamplesOfComponents);
  const Matrix sample = read_rows(all, 0, (n + step - 1) / step, step).rowwise() - mean;
  const Eigen::MatrixXf covariance = sample.transpose() * sample;
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXf> solver(covariance);
  return solver.eigenvectors().rightCols(count);  // Eigenvalues are in ascending order.
}

}  // namespace

struct DescriptorIndex::Impl {
  Impl(DescriptorRows descriptors, const DescriptorIndexOptions& settings);
  void build_cells(const Matrix& data, int num_cells);
  void set_rows(const Matrix& ordered);
  [[nodiscard]] Matrix project(const Block& descriptors) const;
  [[nodiscard]] Matrix project_all() const;
  void scan(const Block& queries, std::span<const int> query_of_row, Index begin, Index end,
            std::vector<BestList>& best) const;
  void search_batch(const Block& queries, int k, DescriptorMatch* results) const;
  [[nodiscard]] Probes probe_cells(const Block& queries) const;
  void scan_cells(const Block& queries, std::vector<BestList>& best) const;
  void scan_rows(const Block& queries, std::vector<BestList>& best) const;
  void settle(const Eigen::RowVectorXf& query, float compared_norm_sq, const BestList& candidates,
              BestList& nearest) const;

  [[nodiscard]] bool is_projected() const { return basis.size() > 0; }

  DescriptorIndexOptions options;
  Index dimension;
  InterleavedRows rows;       // searched rows in cell order: descriptors or their components
  DescriptorRows whole;       // descriptors in the caller's order; empty unless components are searched
  Eigen::RowVectorXf mean;    // mean descriptor
  Matrix basis;               // dimension x components; empty if whole descriptors are compared
  std::vector<int> original;  // index of each row in the caller's order
  Eigen::VectorXf norms_sq;   // squared norms of the rows
  Matrix centroids;           // empty for exact search
  Scores centroid_norms_sq;
  std::vector<Index> cell_begin;  // first row of each cell, then the end
};

DescriptorIndex::Impl::Impl(DescriptorRows descriptors, const DescriptorIndexOptions& settings)
    : options(settings), dimension(descriptors.dimension()) {
  const auto n = static_cast<Index>(descriptors.size());
  const int automatic = static_cast<int>(4 * std::sqrt(static_cast<double>(n)));
  const int num_cells = std::min<int>(options.num_cells.value_or(automatic), static_cast<int>(n));
  if (options.search == IndexSearch::kExact || n < options.exact_below || num_cells <= 1) {
    set_rows(read_rows(descriptors, 0, n));
    original.resize(static_cast<std::size_t>(n));
    std::iota(original.begin(), original.end(), 0);
  } else if (options.num_components && *options.num_components <= dimension / 2) {
    whole = std::move(descriptors);
    mean = mean_of(whole);
    basis = principal_components(whole, mean, *options.num_components);
    build_cells(project_all(), num_cells);
  } else {
    build_cells(read_rows(descriptors, 0, n), num_cells);
  }
}

void DescriptorIndex::Impl::set_rows(const Matrix& ordered) {
  rows = InterleavedRows(ordered);
  norms_sq = ordered.rowwise().squaredNorm();
}

Matrix DescriptorIndex::Impl::project(const Block& descriptors) const {
  const Matrix centered = descriptors.rowwise() - mean;
  return centered * basis;
}

Matrix DescriptorIndex::Impl::project_all() const {
  Matrix projected(static_cast<Index>(whole.size()), basis.cols());
  parallel_for_blocks(whole.size(), kRowsPerBlock, options.num_threads, [&](std::size_t begin, std::size_t end) {
    const auto first = static_cast<Index>(begin);
    const auto count = static_cast<Index>(end) - first;
    projected.middleRows(first, count) = project(read_rows(whole, first, count));
  });
  return projected;
}

void DescriptorIndex::Impl::build_cells(const Matrix& data, int num_cells) {
  centroids = cluster_cells(data, num_cells, options);
  centroid_norms_sq = centroids.rowwise().squaredNorm();
  const std::vector<int> cell = assign_to_cells(data, centroids, options.num_threads);
  cell_begin.assign(static_cast<std::size_t>(num_cells) + 1, 0);
  for (const int c : cell) ++cell_begin[static_cast<std::size_t>(c) + 1];
  std::partial_sum(cell_begin.begin(), cell_begin.end(), cell_begin.begin());
  std::vector<Index> next(cell_begin.begin(), cell_begin.end() - 1);
  Matrix ordered(data.rows(), data.cols());
  original.resize(cell.size());
  for (std::size_t i = 0; i < cell.size(); ++i) {
    const Index row = next[static_cast<std::size_t>(cell[i])]++;
    ordered.row(row) = data.row(static_cast<Index>(i));
    original[static_cast<std::size_t>(row)] = static_cast<int>(i);
  }
  set_rows(ordered);
}

// Compares all `queries` with the rows [begin, end). `query_of_row` gives the list that each query fills.
void DescriptorIndex::Impl::scan(const Block& queries, std::span<const int> query_of_row, Index begin, Index end,
                                 std::vector<BestList>& best) const {
  Scores scores;
  Matrix products;
  for (Index first = begin; first < end; first += kRowsPerBlock) {
    const Index count = std::min(kRowsPerBlock, end - first);
    rows.multiply(queries, first, first + count, products);
    const auto of_rows = products.middleCols(first % InterleavedRows::kLanes, count);
    for (Index q = 0; q < queries.rows(); ++q) {
      BestList& list = best[static_cast<std::size_t>(query_of_row[static_cast<std::size_t>(q)])];
      scores = norms_sq.segment(first, count).array() - 2.0F * of_rows.row(q).transpose().array();
      if (!list.accepts(scores.minCoeff())) continue;  // the usual case, found by vector code
      for (Index r = 0; r < count; ++r)
        if (list.accepts(scores[r])) list.add(static_cast<int>(first + r), scores[r]);
    }
  }
}

Probes DescriptorIndex::Impl::probe_cells(const Block& queries) const {
  const auto num_cells = static_cast<std::size_t>(centroids.rows());
  const auto num_probes = std::min<std::size_t>(static_cast<std::size_t>(options.num_probes), num_cells);
  std::vector<int> cell_of_probe;
  cell_of_probe.reserve(static_cast<std::size_t>(queries.rows()) * num_probes);
  Scores scores(centroids.rows());
  std::vector<DescriptorMatch> nearest;
  for (Index first = 0; first < queries.rows(); first += kQueriesPerBlock) {
    const Index count = std::min(kQueriesPerBlock, queries.rows() - first);
    const Matrix products = queries.middleRows(first, count) * centroids.transpose();
    for (Index q = 0; q < count; ++q) {
      scores = centroid_norms_sq - 2.0F * products.row(q).transpose().array();
      find_nearest_cells(scores, num_probes, nearest);
      for (const DescriptorMatch& cell : nearest) cell_of_probe.push_back(cell.index);
    }
  }
  return sort_by_cell(cell_of_probe, num_probes, num_cells);
}

void DescriptorIndex::Impl::scan_cells(const Block& queries, std::vector<BestList>& best) const {
  const Probes probes = probe_cells(queries);
  Matrix gathered;
  for (std::size_t c = 0; c + 1 < probes.begin.size(); ++c) {
    const std::span<const int> members = probes.queries_of(c);
    if (members.empty() || cell_begin[c] == cell_begin[c + 1]) continue;
    gathered.resize(static_cast<Index>(members.size()), queries.cols());
    for (std::size_t m = 0; m < members.size(); ++m) gathered.row(static_cast<Index>(m)) = queries.row(members[m]);
    scan(gathered, members, cell_begin[c], cell_begin[c + 1], best);
  }
}

void DescriptorIndex::Impl::scan_rows(const Block& queries, std::vector<BestList>& best) const {
  std::vector<int> all(static_cast<std::size_t>(queries.rows()));
  std::iota(all.begin(), all.end(), 0);
  scan(queries, all, 0, rows.size(), best);
}

// Finds the nearest candidates by exact distance and in the caller's order. `compared_norm_sq` is |q|^2 of the compared
// components, which the scores lack.
void DescriptorIndex::Impl::settle(const Eigen::RowVectorXf& query, float compared_norm_sq, const BestList& candidates,
                                   BestList& nearest) const {
  nearest.clear();
  const auto original_of = [&](const DescriptorMatch& candidate) {
    return static_cast<std::size_t>(original[static_cast<std::size_t>(candidate.index)]);
  };
  if (is_projected())
    for (const DescriptorMatch& candidate : candidates.entries()) whole.prefetch(original_of(candidate));
  Eigen::RowVectorXf row(dimension);
  for (const DescriptorMatch& candidate : candidates.entries()) {
    const std::size_t index = original_of(candidate);
    if (is_projected()) {
      // The remaining components can only increase a distance, so all further candidates are farther away.
      if (!nearest.accepts(candidate.distance_sq + compared_norm_sq - kRounding)) break;
      whole.read(index, row.data());
    } else {
      row = rows.row(candidate.index);
    }
    nearest.add(static_cast<int>(index), (query - row).squaredNorm());
  }
}

void DescriptorIndex::Impl::search_batch(const Block& queries, int k, DescriptorMatch* results) const {
  const int num_kept = k + (is_projected() ? kSpareOfComponents : kSpareCandidates);
  std::vector<BestList> best;
  best.reserve(static_cast<std::size_t>(queries.rows()));
  for (Index q = 0; q < queries.rows(); ++q) best.emplace_back(static_cast<std::size_t>(num_kept));
  Matrix projected;
  if (is_projected()) projected = project(queries);
  const Block compared = is_projected() ? Block(projected) : queries;
  if (centroids.rows() > 0)
    scan_cells(compared, best);
  else
    scan_rows(compared, best);
  BestList nearest(static_cast<std::size_t>(k));
  for (Index q = 0; q < queries.rows(); ++q) {
    settle(queries.row(q), compared.row(q).squaredNorm(), best[static_cast<std::size_t>(q)], nearest);
    std::ranges::copy(nearest.entries(), results + q * k);
  }
}

DescriptorIndex::DescriptorIndex(std::span<const float> descriptors, int dimension,
                                 const DescriptorIndexOptions& options)
    : DescriptorIndex(DescriptorRows(descriptors, dimension), options) {}
DescriptorIndex::DescriptorIndex(DescriptorRows descriptors, const DescriptorIndexOptions& options) {
  options.check();
  check_positive("dimension", descriptors.dimension());
  impl_ = std::make_unique<Impl>(std::move(descriptors), options);
}
DescriptorIndex::~DescriptorIndex() = default;
DescriptorIndex::DescriptorIndex(DescriptorIndex&&) noexcept = default;
DescriptorIndex& DescriptorIndex::operator=(DescriptorIndex&&) noexcept = default;

std::vector<DescriptorMatch> DescriptorIndex::search(std::span<const float> queries, int k) const {
  check_positive("k", k);
  const Index dimension = impl_->dimension;
  require(queries.size() % static_cast<std::size_t>(dimension) == 0,
          "DescriptorIndex::search: the number of values is not a multiple of the dimension");
  require(std::all_of(queries.begin(), queries.end(), [](float x) { return std::isfinite(x); }),
          "DescriptorIndex::search: a query is not finite");
  const auto num_queries = static_cast<Index>(queries.size()) / dimension;
  const Eigen::Map<const Matrix> all(queries.data(), num_queries, dimension);
  std::vector<DescriptorMatch> results(static_cast<std::size_t>(num_queries * k));
  const auto count = static_cast<std::size_t>(num_queries);
  const std::size_t batch = std::clamp(count / kWantedBatches, kMinBatch, kMaxBatch);
  parallel_for_blocks(count, batch, impl_->options.num_threads, [&](std::size_t begin, std::size_t end) {
    const auto first = static_cast<Index>(begin);
    impl_->search_batch(all.middleRows(first, static_cast<Index>(end) - first), k, results.data() + first * k);
  });
  return results;
}

std::size_t DescriptorIndex::size() const { return impl_->original.size(); }

}  // namespace resight
