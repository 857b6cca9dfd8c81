// SPDX-License-Identifier: Apache-2.0
#include "resight/evaluation/bop_errors.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "resight/core/check.hpp"
#include "resight/rendering/raycast_scene.hpp"
#include "resight/rendering/view_renderer.hpp"

namespace resight {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// Minimum over the symmetries of the maximum over the vertices. `distance` compares two points in the camera frame.
template <typename Distance>
double symmetric_maximum(const Rigid3& estimate, const Rigid3& truth, std::span<const Eigen::Vector3f> vertices,
                         std::span<const Rigid3> symmetries, Distance&& distance) {
  require(!vertices.empty() && !symmetries.empty(),
          "BOP errors: at least one vertex and one symmetry (the identity) are required");
  double least = kInfinity;
  for (const Rigid3& symmetry : symmetries) {
    const Rigid3 equivalent = truth * symmetry;
    double largest = 0;
    for (const Eigen::Vector3f& vertex : vertices) {
      const Eigen::Vector3d p = vertex.cast<double>();
      largest = std::max(largest, distance(estimate * p, equivalent * p));
      if (largest >= least) break;
    }
    least = std::min(least, largest);
  }
  return least;
}

}  // namespace

double mssd_m(const Rigid3& estimate, const Rigid3& truth, std::span<const Eigen::Vector3f> vertices,
              std::span<const Rigid3> symmetries) {
  return symmetric_maximum(estimate, truth, vertices, symmetries,
                           [](const Eigen::Vector3d& a, const Eigen::Vector3d& b) { return (a - b).norm(); });
}

double mspd_px(const Rigid3& estimate, const Rigid3& truth, std::span<const Eigen::Vector3f> vertices,
               std::span<const Rigid3> symmetries, const Camera& camera) {
  return symmetric_maximum(estimate, truth, vertices, symmetries,
                           [&camera](const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
                             if (a.z() <= 0 || b.z() <= 0) return kInfinity;
                             return (camera.project(a) - camera.project(b)).norm();
                           });
}

Image<float> render_object_depth(const TriangleMesh& mesh, const Camera& camera, const Rigid3& camera_from_object) {
  RaycastScene scene;
  scene.add_instance(scene.add_mesh(mesh), camera_from_object);
  scene.commit();
  Image<float> depth_m(camera.width, camera.height, std::numeric_limits<float>::quiet_NaN());
  std::vector<Ray> rays(static_cast<std::size_t>(camera.width));
  std::vector<RayHit> hits(rays.size());
  const Rigid3f camera_at_origin(Rigid3::identity());
  for (int v = 0; v < camera.height; ++v) {
    for (int u = 0; u < camera.width; ++u)
      rays[static_cast<std::size_t>(u)] =
          pixel_ray(camera, camera_at_origin, static_cast<float>(u), static_cast<float>(v));
    scene.cast(rays, hits);
    for (int u = 0; u < camera.width; ++u)
      if (hits[static_cast<std::size_t>(u)].has_hit()) depth_m(u, v) = hits[static_cast<std::size_t>(u)].distance;
  }
  return depth_m;
}

void VsdOptions::check() const {
  check_positive("VsdOptions.visibility_tolerance_m", visibility_tolerance_m);
  require(!misalignment_shares.empty(), "VsdOptions.misalignment_shares must not be empty");
  for (const double tau : misalignment_shares) check_positive("VsdOptions.misalignment_shares", tau);
}

std::vector<double> vsd_errors(const Image<float>& estimate_depth_m, const Image<float>& truth_depth_m,
                               const Image<float>& measured_depth_m, const Camera& camera, double diameter_m,
                               const VsdOptions& options) {
  options.check();
  check_positive("vsd_errors: diameter_m", diameter_m);
  for (const Image<float>* image : {&estimate_depth_m, &truth_depth_m, &measured_depth_m})
    require(image->width() == camera.width && image->height() == camera.height,
            "vsd_errors: a depth image differs in size from the camera");
  std::size_t num_union = 0;
  std::size_t num_one_only = 0;
  std::vector<std::size_t> num_apart(options.misalignment_shares.size(), 0);
  for (int v = 0; v < camera.height; ++v) {
    for (int u = 0; u < camera.width; ++u) {
      const double ray_length = camera.unproject(u, v, 1.0).norm();
      const double estimate = ray_length * estimate_depth_m(u, v);
      const double truth = ray_length * truth_depth_m(u, v);
      const double measured = ray_length * measured_depth_m(u, v);
      const auto is_visible = [&](double object) {
        return !std::isnan(object) && (std::isnan(measured) || object - measured <= options.visibility_tolerance_m);
      };
      const bool truth_visible = is_visible(truth);
      const bool estimate_visible = is_visible(estimate) || (truth_visible && !std::isnan(estimate));
      if (!truth_visible && !estimate_visible) continue;
      ++num_union;
      if (!truth_visible || !estimate_visible) {
        ++num_one_only;
        continue;
      }
      const double apart = std::abs(truth - estimate) / diameter_m;
      for (std::size_t i = 0; i < num_apart.size(); ++i)
        num_apart[i] += apart >= options.misalignment_shares[i] ? 1 : 0;
    }
  }
  std::vector<double> errors;
  for (const std::size_t count : num_apart)
    errors.push_back(num_union == 0 ? 1.0 : static_cast<double>(count + num_one_only) / static_cast<double>(num_union));
  return errors;
}

}  // namespace resight
