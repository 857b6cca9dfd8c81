// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <cmath>

#include "resight/core/image.hpp"
#include "resight/core/options.hpp"
#include "resight/geometry/camera.hpp"
#include "resight/geometry/point_cloud.hpp"

namespace resight {

/// A cloud on the image grid, camera frame, structure of arrays. NaN in z (and then in all arrays) means no
/// measurement. NaN in nx (and in ny, nz) means no normal; the point may exist. Normals are unit vectors and face the
/// camera.
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

/// Computes the points of a depth image (metres; NaN = no measurement). Throws std::invalid_argument for an invalid
/// camera or an image of another size.
[[nodiscard]] OrganizedCloud back_project(const Camera& camera, const Image<float>& depth_m);

struct ComputeNormalsOptions {
  int window_radius_px = 2;
  double max_depth_change = 0.02;
  int min_neighbors = 6;
  int num_threads = 1;  ///< Same bits for any value >= 1.
  void check() const { check_options("ComputeNormalsOptions", *this); }
};

inline void declare(OptionVisitor& v, ComputeNormalsOptions& o) {
  v.field("window_radius_px", o.window_radius_px, between(1, 100),
          "Normals are fitted to a window of 2 r + 1 pixels. Larger: less noise, rounder edges, slower.");
  v.field("max_depth_change", o.max_depth_change, positive(),
          "Pixels of the window count if their z differs by less than this share of z.");
  v.field("min_neighbors", o.min_neighbors, between(2, 40400), "A point with fewer such pixels has no normal.");
  v.num_threads(o.num_threads);
}

/// Computes normals as the smallest eigenvectors of the covariances of windows, oriented towards the camera. Fills nx,
/// ny, nz with NaN where there is no point, too few neighbours count, or the neighbours lie on a line.
void compute_normals(OrganizedCloud& cloud, const ComputeNormalsOptions& options = {});

/// The points that have a measurement (and a normal, if `require_normal`). Includes normals if the cloud has them, and
/// colours if `color` is given. `pixels`, if given, receives the pixel index of each point.
[[nodiscard]] PointCloud to_point_cloud(const OrganizedCloud& cloud, const Image<Rgb8>* color, bool require_normal,
                                        std::vector<int>* pixels = nullptr);

}  // namespace resight
