// SPDX-License-Identifier: Apache-2.0
#include "resight/rendering/raycast_scene.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "resight/core/random.hpp"
#include "resight/simulation/procedural_objects.hpp"

namespace resight {
namespace {

// A textbook intersection in double precision, without an acceleration structure. Returns infinity for a miss.
double intersect(const Eigen::Vector3d& o, const Eigen::Vector3d& d, const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                 const Eigen::Vector3d& c) {
  Eigen::Matrix3d m;
  m << d, a - b, a - c;
  if (std::abs(m.determinant()) < 1e-18) return std::numeric_limits<double>::infinity();
  const Eigen::Vector3d x = m.inverse() * (a - o);  // t, b1, b2
  const bool inside = x[1] >= 0 && x[2] >= 0 && x[1] + x[2] <= 1 && x[0] > 0;
  return inside ? x[0] : std::numeric_limits<double>::infinity();
}

TriangleMesh random_triangles(int count, std::uint64_t seed) {
  Rng rng(seed);
  TriangleMesh mesh;
  const auto random_vector = [&](double size) {
    const double x = rng.uniform(-size, size);
    const double y = rng.uniform(-size, size);
    const double z = rng.uniform(-size, size);
    return Eigen::Vector3f(static_cast<float>(x), static_cast<float>(y), static_cast<float>(z));
  };
  for (int i = 0; i < count; ++i) {
    const Eigen::Vector3f center = random_vector(0.5);
    for (int k = 0; k < 3; ++k) mesh.vertices.push_back(center + random_vector(0.25));
    mesh.faces.push_back({3 * i, 3 * i + 1, 3 * i + 2});
  }
  return mesh;
}

TEST(RaycastScene, AgreesWithBruteForceOverPosedInstances) {
  const TriangleMesh mesh = random_triangles(60, 3);
  RaycastScene scene;
  const int id = scene.add_mesh(mesh);
  const std::vector<Rigid3> poses{
      Rigid3::from_translation({0.3, 0, 0}) * Rigid3::from_axis_angle({1, 2, 3}, 0.7),
      Rigid3::from_translation({-0.6, 0.2, 0.4}) * Rigid3::from_axis_angle({0, 1, 1}, -2.0)};
  for (const Rigid3& pose : poses) scene.add_instance(id, pose);
  scene.commit();
  Rng rng(4);
  int hits = 0;
  int misses = 0;
  for (int i = 0; i < 600; ++i) {
    const Eigen::Vector3d origin{rng.uniform(-2, 2), rng.uniform(-2, 2), -2.5};
    const Eigen::Vector3d direction = Eigen::Vector3d{0.3 * rng.normal(), 0.3 * rng.normal(), 1.0} -
                                      0.35 * Eigen::Vector3d(origin.x(), origin.y(), 0);
    double nearest = std::numeric_limits<double>::infinity();
    int instance = -1;
    int face = -1;
    for (std::size_t k = 0; k < poses.size(); ++k)
      for (std::size_t f = 0; f < mesh.faces.size(); ++f) {
        const auto corner = [&](int c) {
          return Eigen::Vector3d(poses[k] * mesh.vertices[mesh.faces[f][c]].cast<double>().eval());
        };
        const double t = intersect(origin, direction, corner(0), corner(1), corner(2));
        if (t < nearest) {
          nearest = t;
          instance = static_cast<int>(k);
          face = static_cast<int>(f);
        }
      }
    const RayHit hit = scene.cast({origin.cast<float>(), direction.cast<float>()});
    EXPECT_EQ(hit.instance, instance) << "ray " << i;
    if (instance < 0) {
      ++misses;
      continue;
    }
    ++hits;
    EXPECT_EQ(hit.face, face) << "ray " << i;
    EXPECT_NEAR(hit.distance, nearest, 1e-5);
    // The barycentric weights must give the same point.
    const auto& f = mesh.faces[hit.face];
    const Eigen::Vector3f p =
        hit.b0 * mesh.vertices[f[0]] + hit.b1 * mesh.vertices[f[1]] + (1 - hit.b0 - hit.b1) * mesh.vertices[f[2]];
    EXPECT_LT((poses[instance] * p.cast<double>().eval() - (origin + nearest * direction)).norm(), 1e-5);
    EXPECT_TRUE(
        scene.is_blocked({origin.cast<float>(), direction.cast<float>()}, 0.0F, static_cast<float>(nearest) + 1e-3F));
    EXPECT_FALSE(
        scene.is_blocked({origin.cast<float>(), direction.cast<float>()}, 0.0F, static_cast<float>(nearest) - 1e-3F));
  }
  EXPECT_GT(hits, 150);
  EXPECT_GT(misses, 50);
}

TEST(RaycastScene, FollowsPosesAndVisibility) {
  TriangleMesh box = make_procedural_object("plain_box")->mesh;
  RaycastScene scene;
  const int instance = scene.add_instance(scene.add_mesh(box), Rigid3::identity());
  scene.commit();
  const Ray ray{{0, -1, 0.1F}, {0, 1, 0}};
  EXPECT_NEAR(scene.cast(ray).distance, 1 - 0.055, 1e-6);
  EXPECT_LT((scene.face_normal(scene.cast(ray)) - Eigen::Vector3f(0, -1, 0)).norm(), 1e-6);
  scene.set_pose(instance, Rigid3::from_translation({0, 0.5, 0}) *
                               Rigid3::from_axis_angle(Eigen::Vector3d::UnitZ(), std::numbers::pi / 2));
  scene.commit();
  EXPECT_NEAR(scene.cast(ray).distance, 1.5 - 0.075, 1e-6);
  EXPECT_LT((scene.face_normal(scene.cast(ray)) - Eigen::Vector3f(0, -1, 0)).norm(), 1e-6);
  scene.set_visible(instance, false);
  scene.commit();
  EXPECT_FALSE(scene.cast(ray).has_hit());
  scene.set_visible(instance, true);
  scene.commit();
  EXPECT_TRUE(scene.cast(ray).has_hit());
}

TEST(RaycastScene, SmallFootprintIsSurfaceColorAndLargeOneAMean) {
  const TriangleMesh mesh = make_procedural_object("cereal_red")->mesh;
  RaycastScene scene;
  scene.add_instance(scene.add_mesh(mesh), Rigid3::identity());
  scene.commit();
  Rng rng(5);
  int compared = 0;
  double spread_fine = 0;
  double spread_coarse = 0;
  Eigen::Vector3f last_fine = Eigen::Vector3f::Zero();
  Eigen::Vector3f last_coarse = Eigen::Vector3f::Zero();
  for (int i = 0; i < 300; ++i) {
    const double x = rng.uniform(-0.09, 0.09);
    const double z = rng.uniform(0.01, 0.27);
    const RayHit hit = scene.cast({{static_cast<float>(x), -1, static_cast<float>(z)}, {0, 1, 0}});
    ASSERT_TRUE(hit.has_hit());
    const Rgb8 expected = surface_color(mesh, hit.face, hit.b0, hit.b1);
    const Eigen::Vector3f fine = scene.color(hit, 0);
    EXPECT_NEAR(fine.x(), expected.r, 0.51);
    EXPECT_NEAR(fine.y(), expected.g, 0.51);
    EXPECT_NEAR(fine.z(), expected.b, 0.51);
    const Eigen::Vector3f coarse = scene.color(hit, 0.05F);
    if (i > 0) {
      spread_fine += (fine - last_fine).squaredNorm();
      spread_coarse += (coarse - last_coarse).squaredNorm();
    }
    last_fine = fine;
    last_coarse = coarse;
    ++compared;
  }
  EXPECT_EQ(compared, 300);
  EXPECT_LT(spread_coarse, 0.35 * spread_fine);
}

TEST(RaycastScene, RefusesBadInput) {
  RaycastScene scene;
  EXPECT_THROW(scene.add_mesh(TriangleMesh{}), std::invalid_argument);
  TriangleMesh bad = random_triangles(2, 1);
  bad.faces[1][2] = 6;
  EXPECT_THROW(scene.add_mesh(bad), std::invalid_argument);
  bad = random_triangles(2, 1);
  bad.vertices[4].y() = std::nanf("");
  EXPECT_THROW(scene.add_mesh(bad), std::invalid_argument);
  EXPECT_THROW(scene.add_instance(0, Rigid3::identity()), std::invalid_argument);
  const int mesh = scene.add_mesh(random_triangles(2, 1));
  Rigid3 sheared;
  sheared.rotation(0, 1) = 0.5;
  EXPECT_THROW(scene.add_instance(mesh, sheared), std::invalid_argument);
  EXPECT_THROW(scene.set_pose(0, Rigid3::identity()), std::invalid_argument);
}

}  // namespace
}  // namespace resight
