// SPDX-License-Identifier: Apache-2.0
#include "resight/simulation/surface_sampling.hpp"

#include <algorithm>
#include <cmath>

#include "resight/core/check.hpp"
#include "resight/core/random.hpp"
#include "resight/geometry/fibonacci_sphere.hpp"
#include "resight/rendering/raycast_scene.hpp"

namespace resight {
namespace {

constexpr int kDirections = 64;
constexpr double kSamplesPerCell = 4.0;
constexpr float kGap_m = 5e-4F;

std::vector<Eigen::Vector3f> sphere_directions() {
  std::vector<Eigen::Vector3f> directions;
  for (int i = 0; i < kDirections; ++i) directions.push_back(fibonacci_direction(i, kDirections).cast<float>());
  return directions;
}

bool sees_outside(const RaycastScene& scene, const Eigen::Vector3f& p, const Eigen::Vector3f& normal,
                  const std::vector<Eigen::Vector3f>& directions) {
  return std::ranges::any_of(directions, [&](const Eigen::Vector3f& d) {
    return d.dot(normal) > 0.2F && !scene.is_blocked({p + kGap_m * normal, d}, 0.0F, 1e3F);
  });
}

}  // namespace

PointCloud sample_visible_surface(const TriangleMesh& mesh, double spacing_m) {
  check_positive("sample_visible_surface spacing_m", spacing_m);
  RaycastScene scene;
  scene.add_instance(scene.add_mesh(mesh), Rigid3::identity());
  scene.commit();
  const std::vector<Eigen::Vector3f> directions = sphere_directions();
  Rng rng(1);
  PointCloud cloud;
  double owed = 0;  // samples carried over from faces smaller than one sample
  for (std::size_t face = 0; face < mesh.faces.size(); ++face) {
    const auto& f = mesh.faces[face];
    const Eigen::Vector3f a = mesh.vertices[f[0]], b = mesh.vertices[f[1]], c = mesh.vertices[f[2]];
    const Eigen::Vector3f area_normal = (b - a).cross(c - a);
    owed += 0.5 * area_normal.norm() / (spacing_m * spacing_m) * kSamplesPerCell;
    for (; owed >= 1; owed -= 1) {
      const auto root = static_cast<float>(std::sqrt(rng.uniform()));  // uniform over the triangle
      const auto t = static_cast<float>(rng.uniform());
      const float b0 = 1 - root;
      const float b1 = root * (1 - t);
      const Eigen::Vector3f p = b0 * a + b1 * b + (1 - b0 - b1) * c;
      const Eigen::Vector3f normal = area_normal.normalized();
      if (!sees_outside(scene, p, normal, directions)) continue;
      cloud.points.push_back(p);
      cloud.normals.push_back(normal);
      cloud.colors.push_back(surface_color(mesh, static_cast<int>(face), b0, b1));
    }
  }
  return voxel_downsample(cloud, spacing_m);
}

}  // namespace resight
