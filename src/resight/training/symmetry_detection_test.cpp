// SPDX-License-Identifier: Apache-2.0
#include "resight/training/symmetry_detection.hpp"

#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <numbers>
#include <stdexcept>

#include "resight/core/random.hpp"
#include "resight/training/surface.hpp"

namespace resight {
namespace {

using Eigen::Vector3d;

constexpr double kPi = std::numbers::pi;
constexpr double kSpacing_m = 0.0012;
constexpr Rgb8 kGrey{150, 150, 145};
constexpr Rgb8 kRed{190, 40, 30};

// Points of a surface. The origin is in the middle of the body unless stated otherwise.
struct Shape {
  std::vector<Vector3d> points;
  std::vector<Vector3d> normals;

  // A parallelogram at `corner`, spanned by two edges.
  void add_face(const Vector3d& corner, const Vector3d& a, const Vector3d& b) {
    const int na = std::max(1, static_cast<int>(a.norm() / kSpacing_m));
    const int nb = std::max(1, static_cast<int>(b.norm() / kSpacing_m));
    for (int i = 0; i < na; ++i)
      for (int j = 0; j < nb; ++j) {
        points.emplace_back(corner + (i + 0.5) / na * a + (j + 0.5) / nb * b);
        normals.emplace_back(a.cross(b).normalized());
      }
  }
  void add_box(const Vector3d& center, const Vector3d& size) {
    for (int k = 0; k < 3; ++k) {
      Vector3d edge[3];
      for (int e = 0; e < 3; ++e) edge[e] = Vector3d::Unit((k + e) % 3) * size((k + e) % 3);
      add_face(center + 0.5 * (edge[0] - edge[1] - edge[2]), edge[1], edge[2]);
      add_face(center + 0.5 * (-edge[0] - edge[1] - edge[2]), edge[2], edge[1]);
    }
  }
  // The surface that a path of (radius, height) sweeps about z. The outside is on its right as the path rises.
  void add_lathe(const std::vector<Eigen::Vector2d>& path) {
    for (std::size_t s = 1; s < path.size(); ++s) {
      const Eigen::Vector2d along = path[s] - path[s - 1];
      const int steps = std::max(1, static_cast<int>(along.norm() / kSpacing_m));
      for (int i = 0; i < steps; ++i) add_ring(path[s - 1] + (i + 0.5) / steps * along, along.normalized());
    }
  }
  void add_ring(const Eigen::Vector2d& at, const Eigen::Vector2d& along) {
    const int count = std::max(1, static_cast<int>(2 * kPi * at.x() / kSpacing_m));
    for (int i = 0; i < count; ++i) {
      const double angle = 2 * kPi * i / count;
      points.emplace_back(at.x() * std::cos(angle), at.x() * std::sin(angle), at.y());
      normals.emplace_back(along.y() * std::cos(angle), along.y() * std::sin(angle), -along.x());
    }
  }
  void add_prism(int num_sides, double radius, double height) {
    for (int i = 0; i < num_sides; ++i) {
      const auto corner = [&](int k) {
        return Vector3d(radius * std::cos(2 * kPi * k / num_sides), radius * std::sin(2 * kPi * k / num_sides),
                        -height / 2);
      };
      const Vector3d edge = corner(i + 1) - corner(i);
      add_face(corner(i), edge, {0, 0, height});
      const double apothem = radius * std::cos(kPi / num_sides);  // the lids, as triangles of strips
      for (double r = kSpacing_m / 2; r < apothem; r += kSpacing_m) {
        const double share = r / apothem;
        const int count = std::max(1, static_cast<int>(share * edge.norm() / kSpacing_m));
        for (int j = 0; j < count; ++j) {
          Vector3d p = share * (corner(i) + (j + 0.5) / count * edge);
          for (const double side : {-1.0, 1.0}) {
            p.z() = side * height / 2;
            points.push_back(p);
            normals.emplace_back(0, 0, side);
          }
        }
      }
    }
  }
};

Shape make_box(const Vector3d& size) {
  Shape shape;
  shape.add_box(Vector3d::Zero(), size);
  return shape;
}
Shape make_prism(int num_sides) {
  Shape shape;
  shape.add_prism(num_sides, 0.04, 0.11);
  return shape;
}
Shape make_frustum(double bottom_radius, double top_radius, double height) {
  Shape shape;
  shape.add_lathe({{0, -height / 2}, {bottom_radius, -height / 2}, {top_radius, height / 2}, {0, height / 2}});
  return shape;
}
Shape make_can() { return make_frustum(0.035, 0.035, 0.1); }
Shape make_ball() {
  std::vector<Eigen::Vector2d> path;
  for (int i = 0; i <= 60; ++i) path.emplace_back(0.04 * std::sin(kPi * i / 60), -0.04 * std::cos(kPi * i / 60));
  Shape shape;
  shape.add_lathe(path);
  return shape;
}
Shape make_angle() {
  Shape shape;
  shape.add_box({0.05, 0, 0.01}, {0.1, 0.04, 0.02});
  shape.add_box({0.01, 0, 0.05}, {0.02, 0.04, 0.06});
  return shape;
}
Shape make_mug() {
  Shape shape;
  shape.add_lathe({{0, -0.045}, {0.04, -0.045}, {0.04, 0.045}, {0.036, 0.045}, {0.036, -0.041}, {0, -0.041}});
  shape.add_box({0.06, 0, 0.025}, {0.04, 0.01, 0.01});
  shape.add_box({0.06, 0, -0.025}, {0.04, 0.01, 0.01});
  shape.add_box({0.075, 0, 0}, {0.01, 0.01, 0.04});
  return shape;
}

using Paint = std::function<Rgb8(const Vector3d&)>;
Rgb8 paint_grey(const Vector3d& /*point*/) { return kGrey; }

// Pose and measurement quality of a shape.
struct Placement {
  Rigid3 object_from_shape;
  double noise_m = 0;
};
std::vector<Placement> placements() {
  Rigid3 tilted = Rigid3::from_axis_angle({1, -2, 0.7}, 0.6);
  tilted.translation = {0.3, -0.2, 0.9};
  return {{Rigid3::identity(), 0}, {tilted, 0}, {tilted, 0.0005}};
}

PointCloud measure(const Shape& shape, const Paint& paint, const Placement& placement) {
  Rng rng(3);
  SurfaceSamples samples;
  for (std::size_t i = 0; i < shape.points.size(); ++i) {
    const Vector3d p = shape.points[i] + placement.noise_m * rng.normal() * shape.normals[i];
    samples.cloud.points.push_back((placement.object_from_shape * p).cast<float>());
    samples.cloud.normals.push_back((placement.object_from_shape.rotation * shape.normals[i]).cast<float>());
    Rgb8 color = paint(shape.points[i]);
    const auto vary = [&](std::uint8_t c) {
      return static_cast<std::uint8_t>(std::clamp(c + 8 * rng.normal(), 0., 255.));
    };
    color = {vary(color.r), vary(color.g), vary(color.b)};
    samples.cloud.colors.push_back(color);
  }
  samples.sigma_m.assign(samples.cloud.size(), 0.001F);
  return fuse_surface(samples, 0.003);
}

std::vector<Rigid3> turns(const Vector3d& axis, int order) {
  std::vector<Rigid3> result;
  for (int i = 1; i < order; ++i) result.push_back(Rigid3::from_axis_angle(axis, 2 * kPi * i / order));
  return result;
}
// All rotations about z, and half turns perpendicular to it, the first about `across`.
std::vector<Rigid3> dihedral(int order, const Vector3d& across) {
  std::vector<Rigid3> result = turns({0, 0, 1}, order);
  for (int i = 0; i < order; ++i)
    result.push_back(Rigid3::from_axis_angle({0, 0, 1}, 2 * kPi * i / order) * Rigid3::from_axis_angle(across, kPi));
  return result;
}

struct Motion {
  double angle_rad = 0;
  double shift_m = 0;
};
// Difference of two motions at a point.
Motion difference(const Rigid3& a, const Rigid3& b, const Vector3d& at) {
  return {rotation_angle_rad(a.rotation, b.rotation), (a * at - b * at).norm()};
}

void expect_group(const ObjectSymmetries& symmetries) {
  std::vector<Rigid3> all = symmetries.discrete;
  all.push_back(Rigid3::identity());
  for (const Rigid3& a : symmetries.discrete) {
    EXPECT_GT(rotation_angle_rad(a.rotation, Eigen::Matrix3d::Identity()), 0.3);
    for (const Rigid3& b : all) {
      double nearest = 10;
      for (const Rigid3& c : all) nearest = std::min(nearest, (((a * b).matrix() - c.matrix()).cwiseAbs().maxCoeff()));
      EXPECT_LT(nearest, 1e-7);
    }
  }
}

void expect_discrete(const Shape& shape, const Paint& paint, const std::vector<Rigid3>& wanted,
                     double max_angle_rad = 0.03) {
  for (const Placement& placement : placements()) {
    const ObjectSymmetries found = find_symmetries(measure(shape, paint, placement));
    EXPECT_TRUE(found.continuous.empty());
    EXPECT_EQ(found.discrete.size(), wanted.size());
    expect_group(found);
    const Rigid3& from_shape = placement.object_from_shape;
    for (const Rigid3& motion : wanted) {
      const Rigid3 truth = from_shape * motion * from_shape.inverse();
      const auto is_found = [&](const Rigid3& other) {
        const Motion off = difference(truth, other, from_shape.translation);
        return off.angle_rad < max_angle_rad && off.shift_m < 0.001;
      };
      EXPECT_TRUE(std::ranges::any_of(found.discrete, is_found)) << truth.matrix();
    }
  }
}

// Expects an axis along z, and a half turn perpendicular to it if `can_be_turned_over`.
void expect_round(const Shape& shape, const Paint& paint, bool can_be_turned_over) {
  for (const Placement& placement : placements()) {
    const ObjectSymmetries found = find_symmetries(measure(shape, paint, placement));
    const Vector3d axis = placement.object_from_shape.rotation.col(2);
    const Vector3d center = placement.object_from_shape.translation;
    ASSERT_EQ(found.continuous.size(), 1U);
    EXPECT_LT(found.continuous[0].direction.cross(axis).norm(), 0.02);
    EXPECT_LT((center - found.continuous[0].point).cross(found.continuous[0].direction).norm(), 0.001);
    ASSERT_EQ(found.discrete.size(), can_be_turned_over ? 1U : 0U);
    if (!can_be_turned_over) continue;
    expect_group(found);
    EXPECT_LT((found.discrete[0].rotation * found.continuous[0].direction + found.continuous[0].direction).norm(),
              1e-9);
    EXPECT_LT((found.discrete[0] * center - center).norm(), 0.002);
  }
}

TEST(FindSymmetries, OfUntexturedBoxesAndPrisms) {
  expect_discrete(make_box({0.2, 0.09, 0.05}), paint_grey, dihedral(2, {1, 0, 0}));
  expect_discrete(make_box({0.06, 0.06, 0.11}), paint_grey, dihedral(4, {1, 0, 0}));
  expect_discrete(make_prism(3), paint_grey, dihedral(3, {1, 0, 0}));
  expect_discrete(make_prism(5), paint_grey, dihedral(5, {1, 0, 0}));
  expect_discrete(make_prism(6), paint_grey, dihedral(6, {1, 0, 0}));
}

TEST(FindSymmetries, OfACubeAreAllItsRotations) {
  std::vector<Rigid3> all;
  for (int k = 0; k < 3; ++k)
    for (const Rigid3& turn : turns(Vector3d::Unit(k), 4)) all.push_back(turn);
  for (const double x : {-1.0, 1.0})
    for (const double y : {-1.0, 1.0})
      for (const Rigid3& turn : turns({x, y, 1}, 3)) all.push_back(turn);
  for (const double s : {-1.0, 1.0})
    for (int k = 0; k < 3; ++k)
      all.push_back(Rigid3::from_axis_angle(Vector3d::Unit(k) + s * Vector3d::Unit((k + 1) % 3), kPi));
  ASSERT_EQ(all.size(), 23U);
  expect_discrete(make_box({0.07, 0.07, 0.07}), paint_grey, all);
}

TEST(FindSymmetries, OfRoundThings) {
  expect_round(make_can(), paint_grey, true);
  expect_round(make_frustum(0.05, 0.03, 0.08), paint_grey, false);
  expect_round(make_frustum(0.02, 0.02, 0.0355), paint_grey, true);  // its moments are nearly those of a ball
}

TEST(FindSymmetries, OfABallAreTwoAxes) {
  for (const Placement& placement : placements()) {
    const ObjectSymmetries found = find_symmetries(measure(make_ball(), paint_grey, placement));
    ASSERT_EQ(found.continuous.size(), 2U);
    EXPECT_TRUE(found.discrete.empty());
    EXPECT_LT(std::abs(found.continuous[0].direction.dot(found.continuous[1].direction)), 1e-9);
    for (const auto& c : found.continuous) EXPECT_LT((c.point - placement.object_from_shape.translation).norm(), 0.001);
  }
}

TEST(FindSymmetries, OfThingsWithAHandleOrTwoUnlikeArmsAreNone) {
  expect_discrete(make_angle(), paint_grey, {});
  expect_discrete(make_mug(), paint_grey, {});
}

TEST(FindSymmetries, TextureBreaksThem) {
  const Vector3d size(0.2, 0.09, 0.05);
  const auto on_lid = [&](const Vector3d& p) { return p.z() > 0.499 * size.z() ? kRed : kGrey; };
  expect_discrete(make_box(size), on_lid, turns({0, 0, 1}, 2));
  const auto on_corner = [&](const Vector3d& p) {
    return p.z() > 0.499 * size.z() && p.x() > 0.02 && p.y() > -0.01 ? kRed : kGrey;
  };
  expect_discrete(make_box(size), on_corner, {});
  const auto label = [](const Vector3d& p) {
    return std::abs(p.z()) < 0.03 && std::abs(std::atan2(p.y(), p.x())) < 0.6 && p.x() > 0.025 ? kRed : kGrey;
  };
  // Only the half turn that exchanges the ends of the can keeps a label of one colour in place. If the shape does not
  // determine an axis, the axis is one of the tested directions, which are 5 deg apart; a half turn doubles the error
  // of its axis.
  expect_discrete(make_can(), label, turns({1, 0, 0}, 2), 0.1);
  const auto slanted = [&](const Vector3d& p) {
    return p.x() > 0 && p.y() > 0 && p.z() > 0 && p.z() < 0.04 && p.head<2>().norm() > 0.034 ? kRed : kGrey;
  };
  expect_discrete(make_can(), slanted, {});
  const auto two_labels = [&](const Vector3d& p) { return label({std::abs(p.x()), p.y(), p.z()}); };
  expect_discrete(make_can(), two_labels, dihedral(2, {1, 0, 0}), 0.1);
}

TEST(FindSymmetries, TextureAllAroundLeavesTheAxis) {
  expect_round(
      make_can(), [](const Vector3d& p) { return std::abs(p.z()) < 0.02 ? kRed : kGrey; }, true);
  expect_round(
      make_can(), [](const Vector3d& p) { return p.z() > 0.02 ? kRed : kGrey; }, false);
  expect_round(
      make_can(), [](const Vector3d& p) { return p.z() > 0.0499 ? kRed : kGrey; }, false);
}

TEST(FindSymmetries, WithoutColoursTheShapeDecides) {
  PointCloud surface = measure(make_box({0.2, 0.09, 0.05}), paint_grey, {});
  for (std::size_t i = 0; i < surface.size(); ++i) surface.colors[i] = surface.points[i].x() > 0 ? kRed : kGrey;
  EXPECT_EQ(find_symmetries(surface).discrete.size(), 1U);
  surface.colors.clear();
  EXPECT_EQ(find_symmetries(surface).discrete.size(), 3U);
}

TEST(FindSymmetries, AreSortedByAxis) {
  const ObjectSymmetries prism = find_symmetries(measure(make_box({0.06, 0.06, 0.11}), paint_grey, {}));
  ASSERT_EQ(prism.discrete.size(), 7U);
  for (int i = 0; i < 3; ++i)
    EXPECT_LT(rotation_angle_rad(prism.discrete[i].rotation, turns({0, 0, 1}, 4)[i].rotation), 0.02);
}

TEST(FindSymmetries, WithoutEvidenceThereAreNone) {
  const PointCloud good = measure(make_can(), paint_grey, {});
  ASSERT_FALSE(find_symmetries(good).none());
  EXPECT_TRUE(find_symmetries({}).none());
  PointCloud bad = good;
  bad.normals.clear();
  EXPECT_TRUE(find_symmetries(bad).none());
  bad = good;
  bad.points[7].y() = std::numeric_limits<float>::quiet_NaN();
  EXPECT_TRUE(find_symmetries(bad).none());
  bad = good;
  bad.normals[7].y() = std::numeric_limits<float>::infinity();
  EXPECT_TRUE(find_symmetries(bad).none());
  EXPECT_TRUE(find_symmetries(select(good, std::vector<int>{5})).none());
  bad = select(good, std::vector<int>(500, 5));  // the same point many times
  EXPECT_NO_THROW((void)find_symmetries(bad));
  for (std::size_t i = 0; i < bad.size(); ++i) bad.points[i] = {0, 0, 0.001F * static_cast<float>(i)};
  EXPECT_NO_THROW((void)find_symmetries(bad));
}

TEST(FindSymmetries, OfOneSideOfAnObjectAreNone) {
  const PointCloud all = measure(make_can(), paint_grey, {});
  std::vector<int> seen;
  std::vector<int> without_bottom;
  for (int i = 0; i < static_cast<int>(all.size()); ++i) {
    const Eigen::Vector3f& n = all.normals[static_cast<std::size_t>(i)];
    if (n.x() > 0.1F) seen.push_back(i);
    if (n.z() > -0.5F) without_bottom.push_back(i);
  }
  EXPECT_TRUE(find_symmetries(select(all, seen)).none());
  const ObjectSymmetries scanned = find_symmetries(select(all, without_bottom));
  EXPECT_EQ(scanned.continuous.size(), 1U);
  EXPECT_TRUE(scanned.discrete.empty());
}

TEST(FindSymmetries, OnAnyNumberOfThreadsAreTheSame) {
  for (const Shape& shape : {make_box({0.07, 0.07, 0.07}), make_can(), make_ball()}) {
    const PointCloud surface = measure(shape, paint_grey, placements()[2]);
    const ObjectSymmetries serial = find_symmetries(surface);
    SymmetryOptions options;
    options.num_threads = 4;
    const ObjectSymmetries parallel = find_symmetries(surface, options);
    ASSERT_EQ(parallel.discrete.size(), serial.discrete.size());
    for (std::size_t i = 0; i < serial.discrete.size(); ++i)
      EXPECT_EQ(parallel.discrete[i].matrix(), serial.discrete[i].matrix());
    ASSERT_EQ(parallel.continuous.size(), serial.continuous.size());
    for (std::size_t i = 0; i < serial.continuous.size(); ++i) {
      EXPECT_EQ(parallel.continuous[i].direction, serial.continuous[i].direction);
      EXPECT_EQ(parallel.continuous[i].point, serial.continuous[i].point);
    }
  }
}

TEST(SymmetryOptions, AreChecked) {
  const auto with = [](auto change) {
    SymmetryOptions options;
    change(options);
    return options;
  };
  EXPECT_NO_THROW(SymmetryOptions{}.check());
  EXPECT_THROW(with([](auto& o) { o.min_agreement = 1.1; }).check(), std::invalid_argument);
  EXPECT_THROW(with([](auto& o) { o.max_distance_m = 0; }).check(), std::invalid_argument);
  EXPECT_THROW(with([](auto& o) { o.num_samples = 0; }).check(), std::invalid_argument);
  EXPECT_THROW((void)find_symmetries({}, with([](auto& o) { o.num_threads = 0; })), std::invalid_argument);
}

}  // namespace
}  // namespace resight
