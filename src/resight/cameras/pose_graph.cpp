// SPDX-License-Identifier: Apache-2.0
#include "resight/cameras/pose_graph.hpp"

#include <ceres/ceres.h>
#include <ceres/rotation.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <functional>
#include <utility>

#include "resight/core/check.hpp"
#include "resight/core/disjoint_sets.hpp"
#include "resight/registration/twist.hpp"

namespace resight {
namespace {

// Pose as Ceres stores it: quaternion x y z w (Eigen's order), then translation.
using Parameters = std::array<double, 7>;

Parameters to_parameters(const Rigid3& pose) {
  const Eigen::Quaterniond q(pose.rotation);
  return {q.x(), q.y(), q.z(), q.w(), pose.translation.x(), pose.translation.y(), pose.translation.z()};
}

Rigid3 to_pose(const Parameters& p) {
  return {Eigen::Quaterniond(p[3], p[0], p[1], p[2]).normalized().toRotationMatrix(), {p[4], p[5], p[6]}};
}

// Whitened twist of measured^-1 * (a^-1 b).
class EdgeError {
 public:
  explicit EdgeError(const PoseEdge& edge)
      : b_from_a_(edge.a_from_b.inverse()),
        rotation_(b_from_a_.rotation),
        root_(Eigen::LLT<Eigen::Matrix<double, 6, 6>>(edge.information).matrixU()) {}

  template <typename T>
  bool operator()(const T* a, const T* b, T* residual) const {
    using Vector3 = Eigen::Matrix<T, 3, 1>;
    const Eigen::Map<const Eigen::Quaternion<T>> qa(a), qb(b);
    const Eigen::Map<const Vector3> ta(a + 4), tb(b + 4);
    const Eigen::Quaternion<T> a_from_b = qa.conjugate() * qb;
    const Vector3 shift = qa.conjugate() * (tb - ta);
    Eigen::Quaternion<T> turn = rotation_.template cast<T>() * a_from_b;
    if (turn.w() < T(0)) turn.coeffs() = -turn.coeffs();
    const std::array<T, 4> wxyz{turn.w(), turn.x(), turn.y(), turn.z()};
    Eigen::Matrix<T, 6, 1> twist;
    ceres::QuaternionToAngleAxis(wxyz.data(), twist.data());
    twist.template tail<3>() = rotation_.template cast<T>() * shift + b_from_a_.translation.template cast<T>();
    Eigen::Map<Eigen::Matrix<T, 6, 1>> out(residual);
    out = root_.template cast<T>() * twist;
    return true;
  }

 private:
  Rigid3 b_from_a_;
  Eigen::Quaterniond rotation_;
  Eigen::Matrix<double, 6, 6> root_;
};

void check_edges(std::size_t num_nodes, std::span<const PoseEdge> edges) {
  const auto exists = [&](int node) { return node >= 0 && static_cast<std::size_t>(node) < num_nodes; };
  for (const PoseEdge& edge : edges)
    require(exists(edge.a) && exists(edge.b) && edge.a != edge.b, "edges: must join two nodes of the graph");
}

std::vector<double> find_errors(const std::vector<Rigid3>& poses, std::span<const PoseEdge> edges) {
  std::vector<double> errors;
  for (const PoseEdge& e : edges) {
    const Rigid3 a_from_b = poses[static_cast<std::size_t>(e.a)].inverse() * poses[static_cast<std::size_t>(e.b)];
    const Twist off = to_twist(e.a_from_b.inverse() * a_from_b);
    errors.push_back(off.dot(e.information * off));
  }
  return errors;
}

}  // namespace

void PoseGraphOptions::check() const {
  check_not_negative("loss_scale", loss_scale);
  check_positive("max_iterations", max_iterations);
}

PoseGraph adjust_pose_graph(std::vector<Rigid3> world_from_node, std::span<const PoseEdge> edges,
                            const PoseGraphOptions& options) {
  options.check();
  check_edges(world_from_node.size(), edges);
  std::vector<Parameters> parameters;
  for (const Rigid3& pose : world_from_node) parameters.push_back(to_parameters(pose));
  ceres::Problem problem;
  for (const PoseEdge& edge : edges)
    problem.AddResidualBlock(new ceres::AutoDiffCostFunction<EdgeError, 6, 7, 7>(new EdgeError(edge)),
                             options.loss_scale > 0 ? new ceres::CauchyLoss(options.loss_scale) : nullptr,
                             parameters[static_cast<std::size_t>(edge.a)].data(),
                             parameters[static_cast<std::size_t>(edge.b)].data());
  const std::vector<int> components = find_connected_components(world_from_node.size(), edges);
  std::vector<bool> has_anchor(components.size(), false);
  for (std::size_t n = 0; n < parameters.size(); ++n) {
    double* block = parameters[n].data();
    if (!problem.HasParameterBlock(block)) continue;
    problem.SetManifold(block,
                        new ceres::ProductManifold<ceres::EigenQuaternionManifold, ceres::EuclideanManifold<3>>());
    const auto component = static_cast<std::size_t>(components[n]);
    if (!has_anchor[component]) problem.SetParameterBlockConstant(block);
    has_anchor[component] = true;
  }
  if (!edges.empty()) {
    ceres::Solver::Options solver;
    solver.linear_solver_type = ceres::SPARSE_NORMAL_CHOLESKY;
    solver.sparse_linear_algebra_library_type = ceres::EIGEN_SPARSE;
    solver.max_num_iterations = options.max_iterations;
    solver.logging_type = ceres::SILENT;
    ceres::Solver::Summary summary;
    ceres::Solve(solver, &problem, &summary);
    for (std::size_t n = 0; n < parameters.size(); ++n)
      if (problem.HasParameterBlock(parameters[n].data()) && !problem.IsParameterBlockConstant(parameters[n].data()))
        world_from_node[n] = to_pose(parameters[n]);
  }
  std::vector<double> errors = find_errors(world_from_node, edges);
  return {std::move(world_from_node), std::move(errors)};
}

std::vector<int> find_connected_components(std::size_t num_nodes, std::span<const PoseEdge> edges) {
  check_edges(num_nodes, edges);
  DisjointSets sets(num_nodes);
  for (const PoseEdge& edge : edges) sets.join(edge.a, edge.b);
  std::vector<int> sizes(num_nodes, 0);
  for (std::size_t n = 0; n < num_nodes; ++n) ++sizes[static_cast<std::size_t>(sets.root(static_cast<int>(n)))];
  std::vector<int> roots;
  for (std::size_t n = 0; n < num_nodes; ++n)
    if (sizes[n] > 0) roots.push_back(static_cast<int>(n));
  std::ranges::stable_sort(roots, std::greater<>(), [&](int r) { return sizes[static_cast<std::size_t>(r)]; });
  std::vector<int> number(num_nodes, 0);
  for (std::size_t p = 0; p < roots.size(); ++p) number[static_cast<std::size_t>(roots[p])] = static_cast<int>(p);
  std::vector<int> components;
  for (std::size_t n = 0; n < num_nodes; ++n)
    components.push_back(number[static_cast<std::size_t>(sets.root(static_cast<int>(n)))]);
  return components;
}

}  // namespace resight
