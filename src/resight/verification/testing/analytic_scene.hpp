// SPDX-License-Identifier: Apache-2.0
#pragma once
// A small analytic world for the tests of this module: boxes, cylinders and spheres with colour patterns on a table,
// ray-cast into depth, normals and colour. World: z up, the table's top is z = 0.
#include <Eigen/Core>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <optional>
#include <vector>

#include "resight/verification/hypothesis_verifier.hpp"

namespace resight::analytic {

enum class Shape : std::uint8_t { kBox, kCylinder, kSphere };

using Paint = std::function<Rgb8(const Eigen::Vector3d&)>;  // Of a surface point in the object frame.

inline Paint plain(Rgb8 color) {
  return [color](const Eigen::Vector3d&) { return color; };
}
/// Checks of the given size.
inline Paint checks(Rgb8 a, Rgb8 b, double size_m) {
  return [a, b, size_m](const Eigen::Vector3d& p) {
    const auto cell = [&](double x) { return static_cast<long>(std::floor(x / size_m + 0.31)); };
    return ((cell(p.x()) + cell(p.y()) + cell(p.z())) & 1) != 0 ? a : b;
  };
}

/// A solid about its origin. Box: full side lengths; cylinder: diameter in x, height in z; sphere: diameter in x.
struct Solid {
  Shape shape = Shape::kBox;
  Eigen::Vector3d size_m = Eigen::Vector3d::Constant(0.1);
  Paint paint = plain({128, 128, 128});
  Rigid3 world_from_object;
};

struct RayHit {
  double t = std::numeric_limits<double>::infinity();
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();
};

inline void keep_nearer(RayHit& hit, double t, const Eigen::Vector3d& normal) {
  if (t > 1e-9 && t < hit.t) hit = {t, normal};
}

inline RayHit intersect_box(const Eigen::Vector3d& half, const Eigen::Vector3d& o, const Eigen::Vector3d& d) {
  RayHit hit;
  for (int axis = 0; axis < 3; ++axis) {
    if (d[axis] == 0) continue;
    const double side = d[axis] > 0 ? -1 : 1;
    const double t = (side * half[axis] - o[axis]) / d[axis];
    const Eigen::Vector3d p = o + t * d;
    bool inside = true;
    for (int other = 0; other < 3; ++other) inside = inside && (other == axis || std::abs(p[other]) <= half[other]);
    if (inside) keep_nearer(hit, t, side * Eigen::Vector3d::Unit(axis));
  }
  return hit;
}

// Nearer root of |o + t d|^2 = r^2 in the first `dims` coordinates.
inline std::optional<double> first_root(const Eigen::VectorXd& o, const Eigen::VectorXd& d, double r) {
  const double a = d.squaredNorm();
  const double b = o.dot(d);
  const double discriminant = b * b - a * (o.squaredNorm() - r * r);
  if (a == 0 || discriminant < 0) return std::nullopt;
  return (-b - std::sqrt(discriminant)) / a;
}

inline RayHit intersect_cylinder(double radius, double half_height, const Eigen::Vector3d& o,
                                 const Eigen::Vector3d& d) {
  RayHit hit;
  if (const auto t = first_root(o.head<2>(), d.head<2>(), radius)) {
    const Eigen::Vector3d p = o + *t * d;
    if (std::abs(p.z()) <= half_height) keep_nearer(hit, *t, Eigen::Vector3d(p.x(), p.y(), 0).normalized());
  }
  if (d.z() != 0) {
    const double side = d.z() > 0 ? -1 : 1;
    const double t = (side * half_height - o.z()) / d.z();
    if ((o + t * d).head<2>().norm() <= radius) keep_nearer(hit, t, side * Eigen::Vector3d::UnitZ());
  }
  return hit;
}

/// In the object frame.
inline RayHit intersect(const Solid& solid, const Eigen::Vector3d& o, const Eigen::Vector3d& d) {
  if (solid.shape == Shape::kBox) return intersect_box(solid.size_m / 2, o, d);
  if (solid.shape == Shape::kCylinder) return intersect_cylinder(solid.size_m.x() / 2, solid.size_m.z() / 2, o, d);
  RayHit hit;
  if (const auto t = first_root(o, d, solid.size_m.x() / 2)) keep_nearer(hit, *t, (o + *t * d).normalized());
  return hit;
}

/// A complete surface with normals and colours, one point per `spacing_m`, in the object frame.
inline PointCloud sample_surface(const Solid& solid, double spacing_m) {
  PointCloud cloud;
  const auto add = [&](const Eigen::Vector3d& p, const Eigen::Vector3d& n) {
    cloud.points.push_back(p.cast<float>());
    cloud.normals.push_back(n.cast<float>());
    cloud.colors.push_back(solid.paint(p));
  };
  const Eigen::Vector3d half = solid.size_m / 2;
  const auto steps = [&](double length) { return std::max(1, static_cast<int>(std::ceil(length / spacing_m))); };
  if (solid.shape == Shape::kBox) {
    for (int axis = 0; axis < 3; ++axis) {
      const int a = (axis + 1) % 3;
      const int b = (axis + 2) % 3;
      for (int i = 0; i < steps(solid.size_m[a]); ++i)
        for (int j = 0; j < steps(solid.size_m[b]); ++j)
          for (const double side : {-1.0, 1.0}) {
            Eigen::Vector3d p;
            p[axis] = side * half[axis];
            p[a] = solid.size_m[a] * ((i + 0.5) / steps(solid.size_m[a]) - 0.5);
            p[b] = solid.size_m[b] * ((j + 0.5) / steps(solid.size_m[b]) - 0.5);
            add(p, side * Eigen::Vector3d::Unit(axis));
          }
    }
    return cloud;
  }
  const double r = half.x();
  if (solid.shape == Shape::kSphere) {
    const int n = std::max(20, static_cast<int>(4 * std::numbers::pi * r * r / (spacing_m * spacing_m)));
    for (int i = 0; i < n; ++i) {  // Fibonacci sphere
      const double z = 1 - (2 * i + 1.0) / n;
      const double phi = i * std::numbers::pi * (3 - std::sqrt(5.0));
      const Eigen::Vector3d normal(std::sqrt(1 - z * z) * std::cos(phi), std::sqrt(1 - z * z) * std::sin(phi), z);
      add(r * normal, normal);
    }
    return cloud;
  }
  const int around = steps(2 * std::numbers::pi * r);
  for (int i = 0; i < around; ++i)
    for (int j = 0; j < steps(solid.size_m.z()); ++j) {
      const double phi = 2 * std::numbers::pi * i / around;
      const Eigen::Vector3d normal(std::cos(phi), std::sin(phi), 0);
      add(r * normal + Eigen::Vector3d(0, 0, solid.size_m.z() * ((j + 0.5) / steps(solid.size_m.z()) - 0.5)), normal);
    }
  for (int i = 0; i < steps(2 * r); ++i)
    for (int j = 0; j < steps(2 * r); ++j)
      for (const double side : {-1.0, 1.0}) {
        const Eigen::Vector3d p(2 * r * ((i + 0.5) / steps(2 * r) - 0.5), 2 * r * ((j + 0.5) / steps(2 * r) - 0.5),
                                side * half.z());
        if (p.head<2>().norm() <= r) add(p, side * Eigen::Vector3d::UnitZ());
      }
  return cloud;
}

struct World {
  std::vector<Solid> solids;
  bool has_table = true;
  double table_half_m = 0.6;
  Rgb8 table_color{140, 120, 100};
  double brightness = 1.0;  ///< Exposure of the camera: factor on the colours.
};

inline Camera test_camera() {
  return {.width = 320, .height = 240, .fx = 262.5, .fy = 262.5, .cx = 159.5, .cy = 119.5};
}

/// A camera that looks from `eye` at `target`, world z up.
inline Rigid3 look_at(const Eigen::Vector3d& eye, const Eigen::Vector3d& target) {
  const Eigen::Vector3d z = (target - eye).normalized();
  const Eigen::Vector3d x = z.cross(Eigen::Vector3d::UnitZ()).normalized();
  Rigid3 world_from_camera;
  world_from_camera.rotation << x, z.cross(x), z;
  world_from_camera.translation = eye;
  return world_from_camera;
}

/// Cameras on a circle around the table's centre.
inline std::vector<Rigid3> circle_of_cameras(int count, double radius_m = 0.8, double height_m = 0.6,
                                             double arc_rad = 2 * std::numbers::pi) {
  std::vector<Rigid3> poses;
  for (int i = 0; i < count; ++i) {
    const double phi = arc_rad * i / count;
    poses.push_back(look_at({radius_m * std::cos(phi), radius_m * std::sin(phi), height_m}, {0, 0, 0.03}));
  }
  return poses;
}

inline PreparedView render(const World& world, const Rigid3& world_from_camera, const Camera& camera = test_camera()) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  PreparedView view;
  view.frame.name = "analytic";
  view.frame.camera = camera;
  view.frame.world_from_camera = world_from_camera;
  view.frame.color = Image<Rgb8>(camera.width, camera.height);
  OrganizedCloud& cloud = view.cloud;
  for (Image<float>* image : {&cloud.x, &cloud.y, &cloud.z, &cloud.nx, &cloud.ny, &cloud.nz})
    *image = Image<float>(camera.width, camera.height, nan);
  std::vector<Rigid3> object_from_camera;
  for (const Solid& solid : world.solids)
    object_from_camera.push_back(solid.world_from_object.inverse() * world_from_camera);
  const Rigid3 camera_from_world = world_from_camera.inverse();
  for (int v = 0; v < camera.height; ++v)
    for (int u = 0; u < camera.width; ++u) {
      const Eigen::Vector3d ray = camera.unproject(u, v, 1);
      RayHit nearest;  // In the camera frame; t is the depth.
      Rgb8 color;
      for (std::size_t s = 0; s < world.solids.size(); ++s) {
        const Rigid3& object = object_from_camera[s];
        const RayHit hit = intersect(world.solids[s], object.translation, object.rotation * ray);
        if (!(hit.t < nearest.t)) continue;
        nearest = {hit.t, object.rotation.transpose() * hit.normal};
        color = world.solids[s].paint(object * Eigen::Vector3d(hit.t * ray));
      }
      const Eigen::Vector3d down = world_from_camera.rotation * ray;
      const double t_table = -world_from_camera.translation.z() / down.z();
      const Eigen::Vector3d on_table = world_from_camera.translation + t_table * down;
      if (world.has_table && t_table > 0 && t_table < nearest.t &&
          on_table.head<2>().cwiseAbs().maxCoeff() <= world.table_half_m) {
        nearest = {t_table, camera_from_world.rotation * Eigen::Vector3d::UnitZ()};
        color = world.table_color;
      }
      if (!(nearest.t < std::numeric_limits<double>::infinity())) continue;
      const auto expose = [&](std::uint8_t c) {
        return static_cast<std::uint8_t>(std::min(255.0, c * world.brightness));
      };
      view.frame.color(u, v) = {expose(color.r), expose(color.g), expose(color.b)};
      const Eigen::Vector3d p = nearest.t * ray;
      cloud.x(u, v) = static_cast<float>(p.x());
      cloud.y(u, v) = static_cast<float>(p.y());
      cloud.z(u, v) = static_cast<float>(p.z());
      cloud.nx(u, v) = static_cast<float>(nearest.normal.x());
      cloud.ny(u, v) = static_cast<float>(nearest.normal.y());
      cloud.nz(u, v) = static_cast<float>(nearest.normal.z());
    }
  view.frame.depth_m = cloud.z;
  return view;
}

inline std::vector<PreparedView> render_all(const World& world, const std::vector<Rigid3>& cameras) {
  std::vector<PreparedView> views;
  for (const Rigid3& pose : cameras) views.push_back(render(world, pose));
  return views;
}

/// All points of the views in the world, one per `voxel_m`: a plain reconstruction.
inline PointCloud merge(const std::vector<PreparedView>& views, double voxel_m = 0.005) {
  PointCloud all;
  for (const PreparedView& view : views) {
    const Rigid3f motion(view.frame.world_from_camera);
    for (std::size_t i = 0; i < view.cloud.z.size(); ++i) {
      if (!view.cloud.has_point(i)) continue;
      all.points.push_back(motion * view.cloud.point(i));
      all.normals.push_back(motion.rotation * view.cloud.normal(i));
      all.colors.push_back(view.frame.color[i]);
    }
  }
  return voxel_downsample(all, voxel_m);
}

inline std::vector<VerificationView> references(const std::vector<PreparedView>& views) {
  std::vector<VerificationView> result;
  for (const PreparedView& view : views) result.push_back({&view});
  return result;
}

inline ObjectModel make_model(const std::string& name, const Solid& solid) {
  ObjectModel model;
  model.name = name;
  model.surface = voxel_downsample(sample_surface(solid, 0.0015), 0.003);
  model.diameter_m =
      static_cast<float>(solid.shape == Shape::kBox      ? solid.size_m.norm()
                         : solid.shape == Shape::kSphere ? solid.size_m.x()
                                                         : std::hypot(solid.size_m.x(), solid.size_m.z()));
  return model;
}

inline Hypothesis make_hypothesis(int object, const Rigid3& world_from_object) {
  Hypothesis h;
  h.object = object;
  h.world_from_object = world_from_object;
  return h;
}

/// Pose of an object that stands on the table: turned about z, its centre `height_m` above.
inline Rigid3 on_table(double x, double y, double height_m, double rotation_rad = 0) {
  return Rigid3::from_translation({x, y, height_m}) * Rigid3::from_axis_angle(Eigen::Vector3d::UnitZ(), rotation_rad);
}

/// `pose` moved by `shift_m` in the world and turned by `angle_rad` about an axis through the object's origin.
inline Rigid3 disturb(const Rigid3& pose, const Eigen::Vector3d& shift_m, const Eigen::Vector3d& axis,
                      double angle_rad) {
  Rigid3 result = pose * Rigid3::from_axis_angle(axis, angle_rad);
  result.translation += shift_m;
  return result;
}

}  // namespace resight::analytic
