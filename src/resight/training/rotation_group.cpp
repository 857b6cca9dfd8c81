// SPDX-License-Identifier: Apache-2.0
#include "resight/training/internal/rotation_group.hpp"

#include <algorithm>

#include "resight/geometry/rigid3.hpp"

namespace resight::internal {
namespace {

using Rotations = std::vector<Eigen::Matrix3d>;

constexpr std::size_t kMaxElements = 60;
constexpr double kSameElement_rad = 0.21;  // 12 deg; elements of groups of orders up to 12 are 30 deg apart
constexpr int kPolishingSteps = 6;         // each step squares the error
constexpr double kPolishedError = 1e-9;

// Index of the element nearest to a rotation; -1 if none is near enough to be the same.
int find_element(const Rotations& group, const Eigen::Matrix3d& rotation) {
  int best = -1;
  double best_angle = kSameElement_rad;
  for (std::size_t i = 0; i < group.size(); ++i) {
    const double angle = rotation_angle_rad(group[i], rotation);
    if (angle >= best_angle) continue;
    best_angle = angle;
    best = static_cast<int>(i);
  }
  return best;
}

// Replaces each element b by the mean of (b a) a^-1 over all a. The result is a group except for the square of the
// errors (Grove, Karcher, Ruh 1974). Returns the largest change, or none if a product is not an element.
std::optional<double> average_products(Rotations& group) {
  Rotations sums(group.size(), Eigen::Matrix3d::Zero());
  for (std::size_t b = 0; b < group.size(); ++b)
    for (const Eigen::Matrix3d& a : group) {
      const int product = find_element(group, group[b] * a);
      if (product < 0) return std::nullopt;
      sums[b] += group[static_cast<std::size_t>(product)] * a.transpose();
    }
  double change = 0;
  for (std::size_t b = 0; b < group.size(); ++b) {
    const Eigen::Matrix3d mean = nearest_rotation(sums[b]);
    change = std::max(change, rotation_angle_rad(mean, group[b]));
    group[b] = mean;
  }
  return change;
}

}  // namespace

std::optional<Rotations> generate_rotation_group(std::span<const Eigen::Matrix3d> generators) {
  Rotations group{Eigen::Matrix3d::Identity()};
  for (std::size_t i = 0; i < group.size(); ++i)
    for (const Eigen::Matrix3d& generator : generators) {
      const Eigen::Matrix3d product = group[i] * generator;
      if (find_element(group, product) >= 0) continue;
      if (group.size() == kMaxElements) return std::nullopt;
      group.push_back(product);
    }
  double change = 1;
  for (int step = 0; step < kPolishingSteps && change > kPolishedError; ++step) {
    const std::optional<double> step_change = average_products(group);
    if (!step_change) return std::nullopt;
    change = *step_change;
  }
  if (change > kPolishedError) return std::nullopt;
  group.front().setIdentity();
  return group;
}

}  // namespace resight::internal
