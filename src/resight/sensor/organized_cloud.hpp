// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <cmath>

#include "resight/core/image.hpp"
#include "resight/geometry/camera.hpp"
#include "resight/geometry/point_cloud.hpp"

namespace resight {

/// A cloud on the image grid, camera frame, structure of arrays. NaN in z (and then in all of them) = no measurement;
/// NaN in nx (ny, nz) = no normal there although the point may exist. Normals are unit and face the camera.
struct OrganizedCloud {
  Image<float> x, y, z;
  Image<float> nx, ny, nz;  ///< Empty until compute_normals().

  [[nodiscard]] int width() const { return z.width(); }
  [[nodiscard]] int height() const { return z.height(); }
  [[nodiscard]] bool has_point(std::size_t i) const { return !std::isnan(z[i]); }
  [[nodiscard]] bool has_normal(std::size_t i) const { return !nx.empty() && !std::isnan(nx[i]); }
  [[nodiscard]] Eigen::Vector3f point(std::size_t i) const { return {x[i], y[i], z[i]}; }
  [[nodiscard]] Eigen::Vector3f normal(std::size_t i) const { return {nx[i], ny[i], nz[i]}; }
};

/// Points of a depth image (metres, NaN = none).
[[nodiscard]] OrganizedCloud back_project(const Camera& camera, const Image<float>& depth_m);

struct ComputeNormalsOptions {
  int window_radius_px = 2;        ///< 2 = a 5x5 window.
  double max_depth_change = 0.02;  ///< A neighbour counts when its z differs by less than this share of z.
  int min_neighbors = 6;           ///< Fewer (the pixel itself not counted): no normal.
  int num_threads = 1;             ///< Same bits for any value >= 1.
  void check() const;
};

/// Normals by the covariance of the window's points (smallest eigenvector), turned to the camera. Fills nx, ny, nz. NaN
/// where there is no point, too few neighbours count, or those lie on a line.
void compute_normals(OrganizedCloud& cloud, const ComputeNormalsOptions& options = {});

/// The points that have a measurement (and a normal, if `require_normal`), with normals where the cloud has them and
/// colours where `color` is given; `pixels`, if given, receives the pixel index of each.
[[nodiscard]] PointCloud to_point_cloud(const OrganizedCloud& cloud, const Image<Rgb8>* color, bool require_normal,
                                        std::vector<int>* pixels = nullptr);

}  // namespace resight
