// SPDX-License-Identifier: Apache-2.0
#include "resight/models/surface.hpp"

#include <Eigen/Geometry>
#include <cmath>

#include "resight/core/check.hpp"
#include "resight/geometry/voxel_map.hpp"

namespace resight {
namespace {

constexpr float kOtherSideCosine = -0.5F;

struct WeightedMean {
  Eigen::Vector3d point = Eigen::Vector3d::Zero();
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();
  Eigen::Vector3d color = Eigen::Vector3d::Zero();
  double weight = 0;
  std::size_t first = 0;

  void add(const PointCloud& cloud, std::size_t i, double w) {
    if (weight == 0) first = i;
    point += w * cloud.points[i].cast<double>();
    normal += w * cloud.normals[i].cast<double>();
    color += w * Eigen::Vector3d(cloud.colors[i].r, cloud.colors[i].g, cloud.colors[i].b);
    weight += w;
  }
};

void append_mean(PointCloud& cloud, const WeightedMean& mean, const PointCloud& samples) {
  cloud.points.push_back((mean.point / mean.weight).cast<float>());
  const bool cancelled = mean.normal.norm() < 1e-3 * mean.weight;
  cloud.normals.push_back(cancelled ? samples.normals[mean.first]
                                    : Eigen::Vector3f(mean.normal.normalized().cast<float>()));
  const Eigen::Vector3d c = mean.color / mean.weight;
  const auto round = [](double x) { return static_cast<std::uint8_t>(x + 0.5); };
  cloud.colors.push_back({round(c.x()), round(c.y()), round(c.z())});
}

// Index of the most certain sample of each cube, cubes in order of their first sample.
std::vector<std::size_t> find_best_samples(const SurfaceSamples& samples, VoxelMap& cubes, float inverse_size) {
  std::vector<std::size_t> best;
  for (std::size_t i = 0; i < samples.cloud.size(); ++i) {
    const auto cube = static_cast<std::size_t>(cubes.insert(voxel_key(samples.cloud.points[i], inverse_size)));
    if (cube == best.size())
      best.push_back(i);
    else if (samples.sigma_m[i] < samples.sigma_m[best[cube]])
      best[cube] = i;
  }
  return best;
}

Eigen::Vector3f face_cross(const TriangleMesh& mesh, const std::array<int, 3>& f) {
  return (mesh.vertices[f[1]] - mesh.vertices[f[0]]).cross(mesh.vertices[f[2]] - mesh.vertices[f[0]]);
}

// +1, or -1 for a mesh that is inside out. Six times the signed volume, taken about the centroid, so that open meshes
// are judged by where most of their faces look.
float find_outward_sign(const TriangleMesh& mesh) {
  const Eigen::Vector3f center = centroid(mesh.vertices);
  double volume = 0;
  for (const auto& f : mesh.faces) volume += (mesh.vertices[f[0]] - center).dot(face_cross(mesh, f));
  return volume < 0 ? -1.0F : 1.0F;
}

struct Barycentric {
  float b0 = 0;
  float b1 = 0;
};

// The k-th point of the plastic-number sequence (Roberts 2018), folded from the unit square into the triangle.
Barycentric spread_point(std::size_t k) {
  const double x = std::fmod(0.5 + 0.7548776662466927 * static_cast<double>(k), 1.0);
  const double y = std::fmod(0.5 + 0.5698402909980532 * static_cast<double>(k), 1.0);
  return x + y <= 1 ? Barycentric{static_cast<float>(x), static_cast<float>(y)}
                    : Barycentric{static_cast<float>(1 - x), static_cast<float>(1 - y)};
}

Eigen::Vector3f interpolate(const std::vector<Eigen::Vector3f>& values, const std::array<int, 3>& f, Barycentric b) {
  return b.b0 * values[f[0]] + b.b1 * values[f[1]] + (1 - b.b0 - b.b1) * values[f[2]];
}

Eigen::Vector3f outward_normal(const TriangleMesh& mesh, const std::array<int, 3>& f, Barycentric b,
                               const Eigen::Vector3f& face_normal) {
  if (mesh.normals.size() != mesh.vertices.size()) return face_normal;
  const Eigen::Vector3f smooth = interpolate(mesh.normals, f, b);
  if (!(smooth.norm() > 1e-3F)) return face_normal;
  return (smooth.dot(face_normal) < 0 ? Eigen::Vector3f(-smooth) : smooth).normalized();
}

}  // namespace

SurfaceSamples collect_surface_samples(const PreparedView& view, const Image<std::uint8_t>& mask,
                                       double min_edge_distance_px) {
  const OrganizedCloud& cloud = view.cloud;
  const Rigid3f object_from_camera(view.frame.world_from_camera);
  SurfaceSamples samples;
  for (std::size_t i = 0; i < mask.size(); ++i) {
    if (mask[i] == 0 || !cloud.has_point(i) || !cloud.has_normal(i)) continue;
    if (!(view.edge_distance_px[i] > min_edge_distance_px)) continue;
    samples.cloud.points.push_back(object_from_camera * cloud.point(i));
    samples.cloud.normals.push_back(object_from_camera.rotation * cloud.normal(i));
    samples.cloud.colors.push_back(view.frame.color[i]);
    samples.sigma_m.push_back(std::hypot(view.noise.lateral_m[i], view.noise.axial_m[i]));
  }
  return samples;
}

PointCloud sample_surface(const TriangleMesh& mesh, double samples_per_sq_m) {
  check_positive("samples_per_sq_m", samples_per_sq_m);
  const float sign = find_outward_sign(mesh);
  PointCloud cloud;
  double wanted = 0;  // carried from face to face, so that faces smaller than a sample's share get their due as well
  for (std::size_t face = 0; face < mesh.faces.size(); ++face) {
    const auto& f = mesh.faces[face];
    const Eigen::Vector3f cross = face_cross(mesh, f);
    const float twice_area = cross.norm();
    if (!(twice_area > 0)) continue;
    const Eigen::Vector3f face_normal = cross * (sign / twice_area);
    wanted += 0.5 * twice_area * samples_per_sq_m;
    while (static_cast<double>(cloud.size()) + 0.5 < wanted) {
      const Barycentric b = spread_point(cloud.size());
      cloud.points.push_back(interpolate(mesh.vertices, f, b));
      cloud.normals.push_back(outward_normal(mesh, f, b, face_normal));
      cloud.colors.push_back(surface_color(mesh, static_cast<int>(face), b.b0, b.b1));
    }
  }
  return cloud;
}

PointCloud fuse_surface(const SurfaceSamples& samples, double voxel_size_m) {
  check_positive("voxel_size_m", voxel_size_m);
  require(samples.sigma_m.size() == samples.cloud.size(), "fuse_surface: one sigma is needed for each point");
  require(samples.cloud.empty() || (samples.cloud.has_normals() && samples.cloud.has_colors()),
          "fuse_surface: the points need normals and colours");
  const auto inverse_size = static_cast<float>(1.0 / voxel_size_m);
  VoxelMap cubes(samples.cloud.size() / 4);
  const std::vector<std::size_t> best = find_best_samples(samples, cubes, inverse_size);
  std::vector<WeightedMean> front(best.size());
  std::vector<WeightedMean> back(best.size());
  for (std::size_t i = 0; i < samples.cloud.size(); ++i) {
    const auto cube = static_cast<std::size_t>(cubes.find(voxel_key(samples.cloud.points[i], inverse_size)));
    const bool faces_away = samples.cloud.normals[i].dot(samples.cloud.normals[best[cube]]) < kOtherSideCosine;
    const double sigma = samples.sigma_m[i];
    (faces_away ? back : front)[cube].add(samples.cloud, i, 1.0 / (sigma * sigma));
  }
  PointCloud fused;
  for (std::size_t cube = 0; cube < best.size(); ++cube) {
    append_mean(fused, front[cube], samples.cloud);
    if (back[cube].weight > 0) append_mean(fused, back[cube], samples.cloud);
  }
  return fused;
}

}  // namespace resight
