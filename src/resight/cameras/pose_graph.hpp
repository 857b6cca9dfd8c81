// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <span>
#include <vector>

#include "resight/registration/twist.hpp"

namespace resight {

/// A measured relative pose of two nodes.
struct PoseEdge {
  int a = 0;
  int b = 0;
  Rigid3 a_from_b;
  /// Inverse covariance of a small motion of b in its own frame: rotation vector (rad), then shift (m).
  Eigen::Matrix<double, 6, 6> information = Eigen::Matrix<double, 6, 6>::Identity();
};

struct PoseGraphOptions {
  double loss_scale = 2;  ///< Of Cauchy's loss: edges that are off by more sigmas lose their weight; 0 = squares only.
  int max_iterations = 100;
  void check() const;
};

struct PoseGraph {
  std::vector<Rigid3> world_from_node;
  std::vector<double> error_sq;  ///< Of each edge after the adjustment, in units of its covariance.
};

/// The poses that fit the edges best (Ceres, Levenberg-Marquardt), from `world_from_node` on. The first node of each
/// connected part stays where it is; a node without edges too. Throws std::invalid_argument for an edge between nodes
/// that do not exist or from a node to itself.
[[nodiscard]] PoseGraph adjust_pose_graph(std::vector<Rigid3> world_from_node, std::span<const PoseEdge> edges,
                                          const PoseGraphOptions& options = {});

/// Number of the connected part of each node: 0 for the part with the most nodes (of equal ones that with the first
/// node), and so on.
[[nodiscard]] std::vector<int> find_connected_parts(std::size_t num_nodes, std::span<const PoseEdge> edges);

}  // namespace resight
