// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "resight/registration/correspondence.hpp"

namespace resight {

/// Undirected graph without self-loops as a bit matrix: row i holds the neighbours of vertex i.
class BitGraph {
 public:
  explicit BitGraph(int num_vertices = 0);

  [[nodiscard]] int num_vertices() const { return num_vertices_; }
  /// Number of 64-bit words per row; bits past the last vertex are zero.
  [[nodiscard]] int num_words() const { return num_words_; }
  [[nodiscard]] std::span<const std::uint64_t> row(int vertex) const {
    return std::span(bits_).subspan(static_cast<std::size_t>(vertex) * static_cast<std::size_t>(num_words_),
                                    static_cast<std::size_t>(num_words_));
  }
  [[nodiscard]] bool has_edge(int a, int b) const {
    return (row(a)[static_cast<std::size_t>(b) / 64] >> (static_cast<unsigned>(b) % 64) & 1U) != 0;
  }
  [[nodiscard]] int degree(int vertex) const;
  void add_edge(int a, int b);
  /// Induced subgraph of the given vertices, numbered in the given order.
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

/// Connects correspondences of one object that may belong to one instance. Two are connected if the distance of their
/// points and the dot product of their normals are equal in model and scene, within the limits of `options`, and they
/// share no keypoint. Points must be finite. A NaN normal is no measurement and agrees with all. A feature index of -1
/// (unknown) is never shared.
[[nodiscard]] BitGraph build_consistency_graph(std::span<const Correspondence> correspondences,
                                               const ConsistencyOptions& options);

/// Degeneracy order and core numbers of a graph.
struct Degeneracy {
  /// Vertices in the order of removal: smallest remaining degree first. Of several, the one that came to this degree
  /// last; at the beginning, the one with the smallest index.
  std::vector<int> order;
  /// Core number of each vertex; a clique that contains it has at most core + 1 vertices.
  std::vector<int> core;
};

/// Degeneracy order and core numbers (Matula and Beck 1983).
[[nodiscard]] Degeneracy degeneracy_order(const BitGraph& graph);

}  // namespace resight
