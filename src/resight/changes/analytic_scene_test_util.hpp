// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "resight/sensor/prepared_view.hpp"

namespace resight::testing_scene {

inline constexpr float kNoDepth = std::numeric_limits<float>::quiet_NaN();

/// A box with a vertical axis: `half_m` half its size, turned by `yaw_rad` about z.
struct Box {
  Eigen::Vector3d center;
  Eigen::Vector3d half_m;
  double yaw_rad = 0;
};
struct Sphere {
  Eigen::Vector3d center;
  double radius_m;
};
/// Points p with normal . p = offset; seen from both sides.
struct Plane {
  Eigen::Vector3d normal;
  double offset_m;
};

struct Ray {
  Eigen::Vector3d origin;
  Eigen::Vector3d direction;  // camera z component 1: the ray parameter is the depth
};

inline std::optional<double> hit(const Plane& plane, const Ray& ray) {
  const double slope = plane.normal.dot(ray.direction);
  if (std::abs(slope) < 1e-12) return std::nullopt;
  const double t = (plane.offset_m - plane.normal.dot(ray.origin)) / slope;
  return t > 1e-9 ? std::optional(t) : std::nullopt;
}

inline std::optional<double> hit(const Sphere& sphere, const Ray& ray) {
  const Eigen::Vector3d to_center = sphere.center - ray.origin;
  const double a = ray.direction.squaredNorm();
  const double b = ray.direction.dot(to_center);
  const double root = b * b - a * (to_center.squaredNorm() - sphere.radius_m * sphere.radius_m);
  if (root < 0) return std::nullopt;
  const double t = (b - std::sqrt(root)) / a;
  return t > 1e-9 ? std::optional(t) : std::nullopt;
}

inline std::optional<double> hit(const Box& box, const Ray& ray) {
  const Eigen::Matrix3d box_from_world = Eigen::AngleAxisd(-box.yaw_rad, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  const Eigen::Vector3d o = box_from_world * (ray.origin - box.center);
  const Eigen::Vector3d d = box_from_world * ray.direction;
  double near = 0;
  double far = std::numeric_limits<double>::infinity();
  for (int axis = 0; axis < 3; ++axis) {
    if (std::abs(d[axis]) < 1e-12) {
      if (std::abs(o[axis]) > box.half_m[axis]) return std::nullopt;
      continue;
    }
    const double t0 = (-box.half_m[axis] - o[axis]) / d[axis];
    const double t1 = (box.half_m[axis] - o[axis]) / d[axis];
    near = std::max(near, std::min(t0, t1));
    far = std::min(far, std::max(t0, t1));
  }
  return near > 1e-9 && near <= far ? std::optional(near) : std::nullopt;
}

/// A world of planes, boxes and spheres that is seen exactly. World frame: z up, metres.
struct Scene {
  std::vector<Plane> planes;
  std::vector<Box> boxes;
  std::vector<Sphere> spheres;

  /// Depth of the first surface along the ray; NaN for none.
  [[nodiscard]] double depth(const Ray& ray) const {
    double nearest = std::numeric_limits<double>::infinity();
    const auto look = [&](const auto& shapes) {
      for (const auto& shape : shapes)
        if (const auto t = hit(shape, ray)) nearest = std::min(nearest, *t);
    };
    look(planes);
    look(boxes);
    look(spheres);
    return std::isinf(nearest) ? std::numeric_limits<double>::quiet_NaN() : nearest;
  }
};

/// A table top at z = 0, without end.
inline Scene table() { return {.planes = {{Eigen::Vector3d::UnitZ(), 0.0}}, .boxes = {}, .spheres = {}}; }

/// Half the size of a Kinect's image at the same field of view.
inline Camera small_camera() { return {320, 240, 262.5, 262.5, 159.5, 119.5}; }

/// A camera at `eye` that looks at `target`, its x axis level.
inline Rigid3 look_at(const Eigen::Vector3d& eye, const Eigen::Vector3d& target) {
  Rigid3 world_from_camera;
  const Eigen::Vector3d z = (target - eye).normalized();
  const Eigen::Vector3d x = z.cross(Eigen::Vector3d::UnitZ()).normalized();
  world_from_camera.rotation.col(0) = x;
  world_from_camera.rotation.col(1) = z.cross(x);
  world_from_camera.rotation.col(2) = z;
  world_from_camera.translation = eye;
  return world_from_camera;
}

/// 1.2 m in front of and above the middle of the table.
inline Rigid3 usual_pose() { return look_at({0, -0.9, 0.8}, {0, 0, 0}); }

inline Image<float> render_depth(const Scene& scene, const Camera& camera, const Rigid3& world_from_camera) {
  Image<float> depth_m(camera.width, camera.height);
  for (int v = 0; v < camera.height; ++v)
    for (int u = 0; u < camera.width; ++u)
      depth_m(u, v) = static_cast<float>(
          scene.depth({world_from_camera.translation, world_from_camera.rotation * camera.unproject(u, v, 1)}));
  return depth_m;
}

inline RgbdFrame render(const Scene& scene, const Camera& camera, const Rigid3& world_from_camera,
                        std::string name = "view") {
  return {std::move(name), camera, Image<Rgb8>(camera.width, camera.height, Rgb8{90, 120, 150}),
          render_depth(scene, camera, world_from_camera), world_from_camera};
}

inline PreparedView see(const Scene& scene, const Rigid3& world_from_camera = usual_pose(),
                        const Camera& camera = small_camera()) {
  return prepare_view(render(scene, camera, world_from_camera));
}

/// Every measurement of a view, in the world.
inline PointCloud world_cloud(const PreparedView& view) {
  return transform(view.frame.world_from_camera, to_point_cloud(view.cloud, &view.frame.color, false));
}

/// Whether a point lies on or in the box, larger by `slack_m` all around.
inline bool is_at(const Box& box, const Eigen::Vector3f& p_in_world, double slack_m = 1e-3) {
  const Eigen::Vector3d q =
      Eigen::AngleAxisd(-box.yaw_rad, Eigen::Vector3d::UnitZ()) * (p_in_world.cast<double>() - box.center);
  return (q.cwiseAbs() - box.half_m).maxCoeff() <= slack_m;
}

inline int count_at(const Box& box, const PointCloud& cloud_in_world, double slack_m = 1e-3) {
  return static_cast<int>(std::count_if(cloud_in_world.points.begin(), cloud_in_world.points.end(),
                                        [&](const Eigen::Vector3f& p) { return is_at(box, p, slack_m); }));
}

}  // namespace resight::testing_scene
