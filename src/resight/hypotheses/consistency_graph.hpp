// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "resight/hypotheses/hypothesis.hpp"

namespace resight {

/// An undirected graph without loops as a bit matrix: row i holds the neighbours of vertex i.
class BitGraph {
 public:
  explicit BitGraph(int num_vertices = 0);

  [[nodiscard]] int num_vertices() const { return num_vertices_; }
  /// Of one row, in 64-bit words; bits past the last vertex are zero.
  [[nodiscard]] int num_words() const { return num_words_; }
  [[nodiscard]] std::span<const std::uint64_t> row(int vertex) const {
    return std::span(bits_).subspan(static_cast<std::size_t>(vertex) * static_cast<std::size_t>(num_words_),
                                    static_cast<std::size_t>(num_words_));
  }
  [[nodiscard]] bool has_edge(int a, int b) const {
    return (row(a)[static_cast<std::size_t>(b) / 64] >> (static_cast<unsigned>(b) % 64) & 1U) != 0;
  }
  [[nodiscard]] int degree(int vertex) const;
  [[nodiscard]] std::size_t num_edges() const;
  void add_edge(int a, int b);
  /// The graph of the given vertices, numbered in that order.
  [[nodiscard]] BitGraph subgraph(std::span<const int> vertices) const;

 private:
  int num_vertices_ = 0;
  int num_words_ = 0;
  std::vector<std::uint64_t> bits_;
};

struct ConsistencyOptions {
  double max_distance_difference_m = 0.015;
  double max_dot_difference = 0.2;
  double min_distance_m = 0.005;
};

/// Which correspondences of one object may belong to one instance: an edge where the distance of the two points is the
/// same in model and scene, the dot product of the two normals is the same, and neither keypoint is shared. Points must
/// be finite; a NaN normal is no measurement and agrees with all; a feature index of -1 (unknown) is shared with none.
[[nodiscard]] BitGraph build_consistency_graph(std::span<const Correspondence> correspondences,
                                               const ConsistencyOptions& options);

struct Degeneracy {
  std::vector<int> order;  ///< Vertices as they are peeled off, smallest remaining degree first (ties: smallest index).
  std::vector<int> core;   ///< Core number of each vertex: every clique it is in has at most core + 1 vertices.
};

/// Peels the graph (Matula and Beck 1983).
[[nodiscard]] Degeneracy degeneracy_order(const BitGraph& graph);

}  // namespace resight
