// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <span>
#include <vector>

#include "resight/geometry/rigid3.hpp"

namespace resight {

/// Measured relative pose of two nodes.
struct PoseEdge {
  int a = 0;
  int b = 0;
  Rigid3 a_from_b;
  /// Inverse covariance of a small motion of b in its own frame: rotation vector (rad), then translation (m).
  Eigen::Matrix<double, 6, 6> information = Eigen::Matrix<double, 6, 6>::Identity();
};

struct PoseGraphOptions {
  double loss_scale = 2;  ///< Of Cauchy's loss: edges that are off by more sigmas lose their weight; 0 = squares only.
  int max_iterations = 100;
  void check() const;
};

/// Adjusted poses and the residual of each edge.
struct PoseGraph {
  std::vector<Rigid3> world_from_node;
  /// Squared Mahalanobis distance of each edge after the adjustment.
  std::vector<double> error_sq;
};

/// Adjusts the poses to the edges by nonlinear least squares (Ceres, Levenberg-Marquardt), starting from
/// `world_from_node`. The first node of each connected component and nodes without edges keep their poses. Throws
/// std::invalid_argument for an edge from a node to itself or to a node that does not exist.
[[nodiscard]] PoseGraph adjust_pose_graph(std::vector<Rigid3> world_from_node, std::span<const PoseEdge> edges,
                                          const PoseGraphOptions& options = {});

/// Connected component of each node, sorted by size: 0 is the component with the most nodes (ties: the one with the
/// first node). Throws std::invalid_argument like adjust_pose_graph().
[[nodiscard]] std::vector<int> find_connected_components(std::size_t num_nodes, std::span<const PoseEdge> edges);

}  // namespace resight
