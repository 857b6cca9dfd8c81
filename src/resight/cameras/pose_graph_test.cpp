// SPDX-License-Identifier: Apache-2.0
#include "resight/cameras/pose_graph.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "resight/cameras/trajectory_error.hpp"
#include "resight/core/random.hpp"

namespace resight {
namespace {

Rigid3 random_pose(Rng& rng, double shift_m, double turn_rad) {
  const Eigen::Vector3d axis{rng.normal(), rng.normal(), rng.normal()};
  return {Rigid3::from_axis_angle(axis, turn_rad * rng.normal()).rotation,
          shift_m * Eigen::Vector3d{rng.normal(), rng.normal(), rng.normal()}};
}

PoseEdge edge_between(const std::vector<Rigid3>& poses, int a, int b, double sigma = 0.01) {
  return {a, b, poses[static_cast<std::size_t>(a)].inverse() * poses[static_cast<std::size_t>(b)],
          Eigen::Matrix<double, 6, 6>::Identity() / (sigma * sigma)};
}

// A ring of ten cameras with exact edges and perturbed initial poses.
struct Ring {
  std::vector<Rigid3> truth;
  std::vector<Rigid3> start;
  std::vector<PoseEdge> edges;

  Ring() {
    Rng rng(3);
    for (int n = 0; n < 10; ++n) {
      truth.push_back(Rigid3::from_axis_angle(Eigen::Vector3d::UnitZ(), 0.63 * n) *
                      Rigid3::from_translation({1, 0, 0.3}));
      start.push_back(n == 0 ? truth[0] : truth.back() * random_pose(rng, 0.05, 0.1));
    }
    for (int n = 0; n < 10; ++n) edges.push_back(edge_between(truth, n, (n + 1) % 10));
  }
};

double largest_error(const std::vector<Rigid3>& a, const std::vector<Rigid3>& b) {
  double largest = 0;
  for (std::size_t n = 0; n < a.size(); ++n) largest = std::max(largest, (a[n].matrix() - b[n].matrix()).norm());
  return largest;
}

TEST(PoseGraph, ExactEdgesGiveTheTruth) {
  const Ring ring;
  const PoseGraph graph = adjust_pose_graph(ring.start, ring.edges);
  EXPECT_LT(largest_error(graph.world_from_node, ring.truth), 1e-4);
  EXPECT_EQ(graph.world_from_node[0].matrix(), ring.truth[0].matrix());
  for (const double e : graph.error_sq) EXPECT_LT(e, 1e-3);
}

TEST(PoseGraph, NoiseIsSpreadOverTheRing) {
  Ring ring;
  Rng rng(5);
  for (PoseEdge& edge : ring.edges) edge.a_from_b = edge.a_from_b * random_pose(rng, 0.01, 0.01);
  std::vector<Rigid3> chained{ring.truth[0]};
  for (std::size_t n = 1; n < 10; ++n) chained.push_back(chained.back() * ring.edges[n - 1].a_from_b);
  const PoseGraph graph = adjust_pose_graph(ring.start, ring.edges);
  EXPECT_LT(find_trajectory_error(ring.truth, graph.world_from_node).rms_m,
            0.8 * find_trajectory_error(ring.truth, chained).rms_m);
}

TEST(PoseGraph, AWrongEdgeDoesNotPull) {
  Ring ring;
  ring.edges.push_back(edge_between(ring.truth, 2, 7));
  ring.edges.back().a_from_b = ring.edges.back().a_from_b * Rigid3::from_translation({0.5, 0, 0});
  const PoseGraph robust = adjust_pose_graph(ring.start, ring.edges);
  EXPECT_LT(largest_error(robust.world_from_node, ring.truth), 0.02);
  EXPECT_GT(robust.error_sq.back(), 1000);
  PoseGraphOptions squares;
  squares.loss_scale = 0;
  EXPECT_GT(largest_error(adjust_pose_graph(ring.start, ring.edges, squares).world_from_node, ring.truth), 0.05);
}

TEST(PoseGraph, TheSurerEdgeWins) {
  const std::vector<Rigid3> poses(2);
  std::vector<PoseEdge> edges{edge_between(poses, 0, 1, 0.001), edge_between(poses, 0, 1, 0.1)};
  edges[1].a_from_b = Rigid3::from_translation({0.05, 0, 0});
  const PoseGraph graph = adjust_pose_graph(poses, edges);
  EXPECT_LT(graph.world_from_node[1].translation.norm(), 1e-4);
}

TEST(PoseGraph, PartsKeepTheirPlace) {
  const Ring ring;
  std::vector<PoseEdge> edges{edge_between(ring.truth, 0, 1), edge_between(ring.truth, 4, 5),
                              edge_between(ring.truth, 5, 6)};
  const PoseGraph graph = adjust_pose_graph(ring.start, edges);
  EXPECT_EQ(graph.world_from_node[4].matrix(), ring.start[4].matrix());
  EXPECT_EQ(graph.world_from_node[9].matrix(), ring.start[9].matrix());
  const std::vector<int> components = find_connected_components(10, edges);
  EXPECT_EQ(components, (std::vector<int>{1, 1, 2, 3, 0, 0, 0, 4, 5, 6}));
}

TEST(PoseGraph, NothingToDo) {
  EXPECT_TRUE(adjust_pose_graph({}, {}).world_from_node.empty());
  EXPECT_EQ(adjust_pose_graph({Rigid3{}}, {}).world_from_node.size(), 1U);
}

TEST(PoseGraph, BadEdgesAreRefused) {
  const std::vector<Rigid3> poses(2);
  for (const auto& [a, b] : std::vector<std::pair<int, int>>{{0, 2}, {-1, 0}, {1, 1}}) {
    const std::vector<PoseEdge> edges{{a, b, {}, Eigen::Matrix<double, 6, 6>::Identity()}};
    EXPECT_THROW((void)adjust_pose_graph(poses, edges), std::invalid_argument);
    EXPECT_THROW((void)find_connected_components(2, edges), std::invalid_argument);
  }
}

TEST(TrajectoryError, LeavesOutTheWorldFrame) {
  const Ring ring;
  const Rigid3 world = Rigid3::from_axis_angle({1, 1, 0}, 0.7) * Rigid3::from_translation({1, 2, 3});
  std::vector<Rigid3> moved;
  for (const Rigid3& pose : ring.truth) moved.push_back(world * pose);
  const TrajectoryError same = find_trajectory_error(ring.truth, moved);
  EXPECT_LT(same.max_m, 1e-5);
  EXPECT_LT(same.max_rad, 1e-5);
  moved[3].translation += Eigen::Vector3d(0, 0, 0.1);
  const TrajectoryError off = find_trajectory_error(ring.truth, moved);
  EXPECT_NEAR(off.max_m, 0.09, 0.01);
  EXPECT_NEAR(off.rms_m, 0.1 / std::sqrt(10.0), 0.005);
}

TEST(TrajectoryError, OneViewIsAlwaysRight) {
  const std::vector<Rigid3> one{Rigid3::from_translation({1, 2, 3})};
  const std::vector<Rigid3> other{Rigid3::from_axis_angle({0, 1, 0}, 1)};
  EXPECT_LT(find_trajectory_error(one, other).rms_m, 1e-6);
  EXPECT_EQ(find_trajectory_error({}, {}).num_views, 0);
  EXPECT_THROW((void)find_trajectory_error(one, {}), std::invalid_argument);
}

}  // namespace
}  // namespace resight
