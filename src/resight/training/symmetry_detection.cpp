// SPDX-License-Identifier: Apache-2.0
#include "resight/training/symmetry_detection.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <tuple>

#include "resight/core/parallel.hpp"
#include "resight/geometry/fibonacci_sphere.hpp"
#include "resight/training/internal/rotation_group.hpp"
#include "resight/training/internal/self_overlap.hpp"

namespace resight {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using internal::SelfOverlap;
using Axes = std::vector<RotationAxis>;

constexpr double kPi = std::numbers::pi;
constexpr double kGoldenAngle_rad = 2.399963;  // no two of its multiples are the same rotation
constexpr int kContinuousTurns = 16;           // multiples of kGoldenAngle_rad that must all be symmetries
constexpr double kMaxMeanNormal = 0.35;        // a scan may lack the underside, but not half of the object
constexpr double kAlike = 0.8;                 // principal moments with a larger quotient do not distinguish their axes
constexpr int kCircleDirections = 36;          // 5 deg apart
constexpr int kSphereDirections = 800;         // half of them are tried, 7 deg apart
constexpr double kDirectionError_rad = 0.07;   // largest error of the nearest tested direction
constexpr double kMinRoughShare = 0.8;         // candidates with a smaller share of overlap are not refined
constexpr double kMinSeparation_rad = 0.12;    // of candidates; closer ones converge to the same axis
constexpr std::size_t kMaxRefined = 24;        // candidates per order; an icosahedron has 15 axes of half turns
constexpr std::array kOrders = {12, 10, 8, 6, 5, 4, 3, 2};
constexpr double kMinGain = 0.02;       // of the share, beyond noise: see is_of_order()
constexpr double kSameAxis_rad = 0.17;  // 10 deg: closer axes are one
constexpr std::array<double, 3> kSpinAngles_rad = {kGoldenAngle_rad, 2 * kGoldenAngle_rad, 3 * kGoldenAngle_rad};

bool is_usable(const PointCloud& surface) {
  const auto is_finite = [](const Eigen::Vector3f& v) { return v.allFinite(); };
  return surface.size() >= SelfOverlap::kMinPoints && surface.has_normals() &&
         std::ranges::all_of(surface.points, is_finite) && std::ranges::all_of(surface.normals, is_finite);
}

/// Possible directions of symmetry axes. Axes of orders above 2 and continuous axes are only in `main`.
struct Directions {
  std::vector<Vector3d> main;
  std::vector<Vector3d> half_turn;
};

std::vector<Vector3d> half_sphere() {
  std::vector<Vector3d> directions;
  for (int i = 0; i < kSphereDirections / 2; ++i) directions.push_back(fibonacci_direction(i, kSphereDirections));
  return directions;
}

// A symmetry preserves the tensor of second moments. Its axis is therefore an eigenvector, and if its angle is less
// than half a turn, the other two moments are equal.
Directions find_directions(const Matrix3d& covariance) {
  const Eigen::SelfAdjointEigenSolver<Matrix3d> solver(covariance);
  const Vector3d moments = solver.eigenvalues().cwiseMax(1e-12);  // in ascending order
  const Matrix3d& axes = solver.eigenvectors();
  const bool low_alike = moments(0) > kAlike * moments(1);
  const bool high_alike = moments(1) > kAlike * moments(2);
  Directions directions;
  for (int k = 0; k < 3; ++k) directions.half_turn.emplace_back(axes.col(k));
  if (low_alike && high_alike) {
    directions.main = directions.half_turn;
    for (const Vector3d& d : half_sphere()) directions.main.push_back(d);
    directions.half_turn = directions.main;
  } else if (low_alike || high_alike) {
    directions.main = {axes.col(low_alike ? 2 : 0)};
    for (int i = 0; i < kCircleDirections; ++i) {
      const double angle = kPi * i / kCircleDirections;
      directions.half_turn.emplace_back(std::cos(angle) * axes.col(1) + std::sin(angle) * axes.col(low_alike ? 0 : 2));
    }
  }
  return directions;
}

double angle_between(const Vector3d& a, const Vector3d& b) { return std::atan2(a.cross(b).norm(), std::abs(a.dot(b))); }

// Directions with the highest shares, best first. Omits those with share 0 and those close to a better one.
std::vector<Vector3d> pick_best(const std::vector<Vector3d>& directions, const std::vector<double>& shares) {
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < directions.size(); ++i)
    if (shares[i] > 0) order.push_back(i);
  std::ranges::stable_sort(order, [&](std::size_t a, std::size_t b) { return shares[a] > shares[b]; });
  std::vector<Vector3d> picked;
  for (const std::size_t i : order) {
    if (picked.size() == kMaxRefined) break;
    const auto is_near = [&](const Vector3d& other) {
      return angle_between(directions[i], other) < kMinSeparation_rad;
    };
    if (std::ranges::none_of(picked, is_near)) picked.push_back(directions[i]);
  }
  return picked;
}

// Axes through the centre about which rotations by all the angles may be symmetries, best first.
Axes find_rough_axes(const SelfOverlap& overlap, const std::vector<Vector3d>& directions,
                     std::span<const double> angles_rad, int num_threads) {
  std::vector<double> shares(directions.size(), 1.0);
  parallel_for(directions.size(), num_threads, [&](std::size_t i) {
    for (const double angle : angles_rad) {
      if (shares[i] == 0) return;
      // An error e of the axis displaces the result of a rotation about it by 2 sin(angle / 2) e.
      const double slack_rad = 2 * std::abs(std::sin(angle / 2)) * kDirectionError_rad;
      const Rigid3 motion = rotation_about({directions[i], overlap.center()}, angle);
      shares[i] = std::min(shares[i], overlap.rough_share(motion, slack_rad, kMinRoughShare));
    }
  });
  Axes axes;
  for (const Vector3d& direction : pick_best(directions, shares)) axes.push_back({direction, overlap.center()});
  return axes;
}

// Refines rough axes and keeps those that pass a test. Of axes that have become the same, the first is kept.
template <typename Test>
Axes keep_true_axes(const SelfOverlap& overlap, Axes axes, std::span<const double> angles_rad, int num_threads,
                    const Test& test) {
  std::vector<char> holds(axes.size());
  parallel_for(axes.size(), num_threads, [&](std::size_t i) {
    axes[i] = overlap.refine(axes[i], angles_rad);
    holds[i] = test(axes[i]) ? 1 : 0;
  });
  Axes kept;
  for (std::size_t i = 0; i < axes.size(); ++i) {
    const auto is_same = [&](const RotationAxis& other) {
      return angle_between(axes[i].direction, other.direction) < kSameAxis_rad;
    };
    if (holds[i] != 0 && std::ranges::none_of(kept, is_same)) kept.push_back(axes[i]);
  }
  return kept;
}

bool is_continuous(const SelfOverlap& overlap, const RotationAxis& axis) {
  for (int k = 1; k <= kContinuousTurns; ++k)
    if (!overlap.is_symmetry(rotation_about(axis, k * kGoldenAngle_rad))) return false;
  return true;
}

/// The point nearest to all axes. Where they do not determine it, it is as close as possible to `center`.
Vector3d meeting_point(const Axes& axes, const Vector3d& center) {
  constexpr double kPull = 1e-6;
  Matrix3d a = kPull * Matrix3d::Identity();
  Vector3d b = kPull * center;
  for (const RotationAxis& axis : axes) {
    const Matrix3d off_axis = Matrix3d::Identity() - axis.direction * axis.direction.transpose();
    a += off_axis;
    b += off_axis * axis.point;
  }
  return a.ldlt().solve(b);
}

Vector3d any_perpendicular(const Vector3d& direction) {
  const Vector3d least = std::abs(direction.x()) < 0.9 ? Vector3d::UnitX() : Vector3d::UnitY();
  return (least - least.dot(direction) * direction).normalized();
}

// Chooses the sign that makes the largest component positive.
Vector3d canonical(const Vector3d& direction) {
  Eigen::Index largest = 0;
  direction.cwiseAbs().maxCoeff(&largest);
  return direction(largest) < 0 ? Vector3d(-direction) : direction;
}

// Tests a second axis perpendicular to the first one. If both are continuous, the object is a ball.
std::optional<ObjectSymmetries> complete_ball(const SelfOverlap& overlap, const RotationAxis& axis) {
  const RotationAxis across =
      overlap.refine({any_perpendicular(axis.direction), meeting_point({axis}, overlap.center())}, kSpinAngles_rad);
  if (!is_continuous(overlap, across)) return std::nullopt;
  const Vector3d center = meeting_point({axis, across}, overlap.center());
  const Vector3d second = (across.direction - across.direction.dot(axis.direction) * axis.direction).normalized();
  const Vector3d third = axis.direction.cross(second);
  for (const Vector3d& direction : {axis.direction, second, third})
    if (!is_continuous(overlap, {direction, center})) return std::nullopt;
  ObjectSymmetries ball;
  ball.continuous = {{canonical(axis.direction), center}, {canonical(second), center}};
  return ball;
}

// A half turn perpendicular to the axis, if the object is the same upside down.
std::optional<Rigid3> find_flip(const SelfOverlap& overlap, const RotationAxis& axis) {
  const Vector3d start = meeting_point({axis}, overlap.center());
  const RotationAxis across = overlap.refine({any_perpendicular(axis.direction), start}, std::array{kPi});
  // Only the position along the axis is unknown; the axis determines the rest.
  const Vector3d point = axis.point + axis.direction.dot(across.point - axis.point) * axis.direction;
  const Rigid3 flip = rotation_about({any_perpendicular(axis.direction), point}, kPi);
  return overlap.is_symmetry(flip) ? std::optional(flip) : std::nullopt;
}

std::optional<ObjectSymmetries> find_round(const SelfOverlap& overlap, const Directions& directions, int num_threads) {
  const Axes rough = find_rough_axes(overlap, directions.main, kSpinAngles_rad, num_threads);
  const Axes axes = keep_true_axes(overlap, rough, kSpinAngles_rad, num_threads,
                                   [&](const RotationAxis& axis) { return is_continuous(overlap, axis); });
  if (axes.empty()) return std::nullopt;
  if (std::optional<ObjectSymmetries> ball = complete_ball(overlap, axes.front())) return ball;
  ObjectSymmetries round;
  round.continuous.push_back({canonical(axes.front().direction), meeting_point({axes.front()}, overlap.center())});
  if (const std::optional<Rigid3> flip = find_flip(overlap, axes.front())) round.discrete.push_back(*flip);
  return round;
}

/// An axis with the order of the rotations about it.
struct OrderedAxis {
  RotationAxis axis;
  int order = 2;
};

// A rotation that fits no better than half of its angle does not determine the order: a round object with slightly
// varying colours passes at some angles and fails at others.
bool is_of_order(const SelfOverlap& overlap, const RotationAxis& axis, int order) {
  const Rigid3 motion = rotation_about(axis, 2 * kPi / order);
  return overlap.is_symmetry(motion) &&
         overlap.share(motion) > overlap.share(rotation_about(axis, kPi / order)) + kMinGain;
}

// Axes in descending order. For each axis, omits rotations that follow from those found before.
std::vector<OrderedAxis> find_ordered_axes(const SelfOverlap& overlap, const Directions& directions, int num_threads) {
  std::vector<OrderedAxis> found;
  for (const int order : kOrders) {
    const std::array<double, 1> angle = {2 * kPi / order};
    const Axes rough =
        find_rough_axes(overlap, order == 2 ? directions.half_turn : directions.main, angle, num_threads);
    const Axes axes = keep_true_axes(overlap, rough, angle, num_threads,
                                     [&](const RotationAxis& axis) { return is_of_order(overlap, axis, order); });
    for (const RotationAxis& axis : axes) {
      const auto follows = [&](const OrderedAxis& other) {
        return other.order % order == 0 && angle_between(axis.direction, other.axis.direction) < kSameAxis_rad;
      };
      if (std::ranges::none_of(found, follows)) found.push_back({axis, order});
    }
  }
  return found;
}

// All motions of the group that the rotations generate, without the identity, provided that each of them is a symmetry.
std::optional<std::vector<Rigid3>> complete_group(const SelfOverlap& overlap, const std::vector<OrderedAxis>& ordered) {
  std::vector<Matrix3d> generators;
  Axes axes;
  for (const auto& [axis, order] : ordered) {
    generators.push_back(Rigid3::from_axis_angle(axis.direction, 2 * kPi / order).rotation);
    axes.push_back(axis);
  }
  const auto rotations = internal::generate_rotation_group(generators);
  if (!rotations) return std::nullopt;
  const Vector3d center = meeting_point(axes, overlap.center());
  std::vector<Rigid3> motions;
  for (std::size_t i = 1; i < rotations->size(); ++i) {
    const Matrix3d& rotation = (*rotations)[i];
    motions.push_back({rotation, center - rotation * center});
    if (!overlap.is_symmetry(motions.back())) return std::nullopt;
  }
  return motions;
}

// Sorts by axis (highest order first, then x before y before z), and for each axis by angle.
void sort_motions(std::vector<Rigid3>& motions) {
  struct Entry {
    Rigid3 motion;
    Vector3d axis;
    double angle_rad = 0;
    std::ptrdiff_t order = 0;
  };
  std::vector<Entry> entries;
  for (const Rigid3& motion : motions) {
    const Eigen::AngleAxisd rotation(motion.rotation);
    const Vector3d axis = canonical(rotation.axis());
    const double angle = axis.dot(rotation.axis()) < 0 ? 2 * kPi - rotation.angle() : rotation.angle();
    entries.push_back({motion, axis, angle});
  }
  for (Entry& entry : entries)
    entry.order =
        std::ranges::count_if(entries, [&](const Entry& other) { return other.axis.cross(entry.axis).norm() < 1e-6; });
  const auto key = [](const Entry& e) {
    const auto rounded = [](double x) { return std::lround(-1e4 * x); };
    return std::tuple(-e.order, rounded(e.axis.x()), rounded(e.axis.y()), rounded(e.axis.z()), e.angle_rad);
  };
  std::ranges::stable_sort(entries, {}, key);
  for (std::size_t i = 0; i < entries.size(); ++i) motions[i] = entries[i].motion;
}

// The largest group that is found by adding the rotations one by one.
std::vector<Rigid3> find_discrete(const SelfOverlap& overlap, const Directions& directions, int num_threads) {
  std::vector<OrderedAxis> ordered;
  std::vector<Rigid3> motions;
  for (const OrderedAxis& axis : find_ordered_axes(overlap, directions, num_threads)) {
    ordered.push_back(axis);
    if (auto group = complete_group(overlap, ordered))
      motions = *std::move(group);
    else
      ordered.pop_back();
  }
  sort_motions(motions);
  return motions;
}

}  // namespace

ObjectSymmetries find_symmetries(const PointCloud& surface, const SymmetryOptions& options) {
  options.check();
  if (!is_usable(surface)) return {};
  const SelfOverlap overlap(surface, options);
  if (!(overlap.mean_normal_length() < kMaxMeanNormal)) return {};
  const Directions directions = find_directions(overlap.covariance());
  if (std::optional<ObjectSymmetries> round = find_round(overlap, directions, options.num_threads)) return *round;
  ObjectSymmetries symmetries;
  symmetries.discrete = find_discrete(overlap, directions, options.num_threads);
  return symmetries;
}

}  // namespace resight
