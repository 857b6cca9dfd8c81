// SPDX-License-Identifier: Apache-2.0
#include "resight/io/organized_pcd.hpp"

#include <fmt/format.h>

#include <cmath>
#include <limits>

#include "resight/core/check.hpp"
#include "resight/io/images.hpp"

namespace resight {
namespace {

bool is_return(const Eigen::Vector3f& p) { return p.allFinite() && p.z() > 0 && p.z() <= kMaxReturn_m; }

/// Fits pixel = f * slope + c by least squares.
class LineFit {
 public:
  void add(double slope, double pixel) {
    ++n_;
    sum_s_ += slope;
    sum_p_ += pixel;
    sum_ss_ += slope * slope;
    sum_sp_ += slope * pixel;
    sum_pp_ += pixel * pixel;
  }
  /// Returns false if the slopes do not vary.
  bool solve() {
    const double var_s = sum_ss_ / n_ - (sum_s_ / n_) * (sum_s_ / n_);
    const double var_p = sum_pp_ / n_ - (sum_p_ / n_) * (sum_p_ / n_);
    const double cov = sum_sp_ / n_ - (sum_s_ / n_) * (sum_p_ / n_);
    if (!(var_s > 1e-12) || !(var_p > 1.0) || !(cov > 0)) return false;
    focal = cov / var_s;
    center = (sum_p_ - focal * sum_s_) / n_;
    residual_sq = std::max(0.0, var_p - cov * cov / var_s);
    return std::isfinite(focal) && std::isfinite(center);
  }
  double focal = 0;
  double center = 0;
  double residual_sq = 0;  ///< Mean squared residual, px^2.

 private:
  double n_ = 0, sum_s_ = 0, sum_p_ = 0, sum_ss_ = 0, sum_sp_ = 0, sum_pp_ = 0;
};

Result<Camera> find_camera(const PcdCloud& cloud, std::span<const Eigen::Vector3f> points_in_camera,
                           std::string_view name) {
  if (cloud.camera) return *cloud.camera;
  const auto fit = fit_camera(points_in_camera, cloud.width, cloud.height);
  if (!fit) return Camera{cloud.width, cloud.height, 525, 525, (cloud.width - 1) / 2.0, (cloud.height - 1) / 2.0};
  if (fit->residual_px > kMaxCameraResidual_px)
    return Error{fmt::format(
        "{}: its points do not lie on the pixel grid of a pinhole camera ({:.1f} px off); expected an organised "
        "cloud in the camera frame",
        name, fit->residual_px)};
  return fit->camera;
}

}  // namespace

std::optional<CameraFit> fit_camera(std::span<const Eigen::Vector3f> points, int width, int height) {
  require(points.size() == static_cast<std::size_t>(width) * static_cast<std::size_t>(height),
          "fit_camera: width x height must be the number of points");
  LineFit horizontal;
  LineFit vertical;
  int num_points = 0;
  for (int v = 0; v < height; ++v)
    for (int u = 0; u < width; ++u) {
      const Eigen::Vector3f& p =
          points[static_cast<std::size_t>(v) * static_cast<std::size_t>(width) + static_cast<std::size_t>(u)];
      if (!is_return(p)) continue;
      // Pixels are relative to the image centre, which keeps the sums small and exact.
      horizontal.add(static_cast<double>(p.x()) / p.z(), u - width / 2.0);
      vertical.add(static_cast<double>(p.y()) / p.z(), v - height / 2.0);
      ++num_points;
    }
  if (num_points < kMinPointsForCamera || !horizontal.solve() || !vertical.solve()) return std::nullopt;
  CameraFit fit;
  fit.camera = {
      width, height, horizontal.focal, vertical.focal, horizontal.center + width / 2.0, vertical.center + height / 2.0};
  fit.residual_px = std::sqrt(horizontal.residual_sq + vertical.residual_sq);
  fit.num_points = num_points;
  return fit;
}

Rigid3 find_points_from_camera(std::span<const Eigen::Vector3f> points) {
  bool any_behind = false;
  for (const Eigen::Vector3f& p : points) {
    if (!p.allFinite() || p.z() == 0) continue;
    if (p.z() > 0) return Rigid3::identity();
    any_behind = true;
  }
  if (!any_behind) return Rigid3::identity();
  return Rigid3::from_rotation(Eigen::Vector3d(1, -1, -1).asDiagonal());
}

Result<RgbdFrame> to_frame(const PcdCloud& cloud, std::string_view name) {
  if (!cloud.is_organized() || cloud.width < 2)
    return Error{fmt::format("{}: is not an organised cloud (WIDTH {} HEIGHT {}); expected the image grid of a camera",
                             name, cloud.width, cloud.height)};
  if (cloud.points.size() > static_cast<std::size_t>(kMaxViewPixels))
    return Error{fmt::format("{}: has {} pixels (at most {})", name, cloud.points.size(), kMaxViewPixels)};
  if (cloud.colors.size() != cloud.points.size())
    return Error{fmt::format("{}: has no colours (expected a field rgb or rgba)", name)};
  const Rigid3 points_from_camera = find_points_from_camera(cloud.points);
  const bool turned = points_from_camera.rotation(2, 2) < 0;
  std::vector<Eigen::Vector3f> points_in_camera = cloud.points;
  if (turned)
    for (Eigen::Vector3f& p : points_in_camera) p = {p.x(), -p.y(), -p.z()};
  const auto camera = find_camera(cloud, points_in_camera, name);
  if (!camera) return camera.error();
  RgbdFrame frame{std::string(name), *camera, Image<Rgb8>(cloud.width, cloud.height, cloud.colors),
                  Image<float>(cloud.width, cloud.height),
                  turned ? cloud.viewpoint * points_from_camera : cloud.viewpoint};
  for (std::size_t i = 0; i < points_in_camera.size(); ++i)
    frame.depth_m[i] =
        is_return(points_in_camera[i]) ? points_in_camera[i].z() : std::numeric_limits<float>::quiet_NaN();
  return frame;
}

PcdCloud to_pcd_cloud(const RgbdFrame& frame) {
  PcdCloud cloud;
  cloud.width = frame.depth_m.width();
  cloud.height = frame.depth_m.height();
  cloud.camera = frame.camera;
  cloud.viewpoint = frame.world_from_camera;
  cloud.colors.assign(frame.color.data().begin(), frame.color.data().end());
  cloud.points.resize(frame.depth_m.size());
  for (int v = 0; v < cloud.height; ++v)
    for (int u = 0; u < cloud.width; ++u) {
      const std::size_t i = frame.depth_m.index(u, v);
      const float z = frame.depth_m[i];
      // NaN depth makes all three coordinates NaN, as the format requires.
      cloud.points[i] = frame.camera.unproject(u, v, z).cast<float>();
      cloud.points[i].z() = z;
    }
  return cloud;
}

}  // namespace resight
