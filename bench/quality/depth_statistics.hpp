// SPDX-License-Identifier: Apache-2.0
// Noise and holes of depth images, measured without knowing the scene.
#pragma once
#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "resight/core/statistics.hpp"
#include "resight/sensor/rgbd_frame.hpp"

namespace resight {

/// Share of pixels without depth among those of a class.
struct HoleCount {
  double holes = 0;
  double pixels = 0;
  void add(bool is_hole) {
    holes += is_hole ? 1 : 0;
    pixels += 1;
  }
  [[nodiscard]] double share() const { return pixels >= 500 ? holes / pixels : std::nan(""); }
};

class DepthStatistics {
 public:
  static constexpr std::array<double, 6> kRanges_m{0.2, 0.8, 1.2, 1.8, 2.5, 4.0};
  static constexpr std::array<double, 5> kAngles_deg{0, 30, 50, 65, 80};
  static constexpr std::array<double, 4> kEdgeDistances_px{0, 3, 8, 1e9};
  static constexpr std::array<int, 6> kBrightness{0, 30, 80, 160, 245, 256};

  void add(const RgbdFrame& frame) {
    for (const float z : frame.depth_m.data()) all_.add(std::isnan(z));
    add_windows(frame);
    add_hole_places(frame);
  }

  /// Median over flat windows of the residual to the local plane, surfaces slanted less than 50 deg.
  [[nodiscard]] double noise_m(std::size_t range) const { return median_of_enough(noise_by_range_[range]); }
  /// Median ratio of the residual to that of surfaces that face the camera: residual divided by z^2.
  [[nodiscard]] double noise_per_z_sq(std::size_t angle) const { return median_of_enough(noise_by_angle_[angle]); }
  /// Correlation of the residuals of neighbouring pixels.
  [[nodiscard]] double correlation() const { return median_of_enough(correlation_); }
  [[nodiscard]] double hole_share() const { return all_.share(); }
  [[nodiscard]] double hole_share_at_angle(std::size_t i) const { return by_angle_[i].share(); }
  [[nodiscard]] double hole_share_at_edge_distance(std::size_t i) const { return by_edge_[i].share(); }
  [[nodiscard]] double hole_share_at_brightness(std::size_t i) const { return by_brightness_[i].share(); }

 private:
  static double median_of_enough(const std::vector<double>& values) {
    constexpr std::size_t kEnough = 10;
    return values.size() < kEnough ? std::nan("") : upper_median(values);
  }
  static constexpr int kWindow_px = 21;
  static constexpr double kMaxResidualShare = 0.01;  // of z^2; twice the RMS beyond which a window is no plane,
  static constexpr double kMaxRms_m = 0.004;         // unless it is below this

  struct Plane {
    Eigen::Vector3d inverse_depth;  // 1 / z = a u + b v + c
    double rms_m = 0;
    double z_m = 0;
    double angle_deg = 0;
    double correlation = 0;
    double valid_share = 0;
  };

  template <std::size_t N, typename T>
  static int bin_of(const std::array<T, N>& limits, double value) {
    for (std::size_t i = 0; i + 1 < N; ++i)
      if (value >= limits[i] && value < limits[i + 1]) return static_cast<int>(i);
    return -1;
  }

  // A plane is linear in inverse depth. Fits it, and again without outliers, such as those beside a hole.
  static bool fit_plane(const RgbdFrame& frame, int u0, int v0, Plane& plane) {
    double limit = 1e9;
    for (int pass = 0; pass < 2; ++pass) {
      Eigen::Matrix3d a = Eigen::Matrix3d::Zero();
      Eigen::Vector3d b = Eigen::Vector3d::Zero();
      double count = 0;
      for (int v = 0; v < kWindow_px; ++v)
        for (int u = 0; u < kWindow_px; ++u) {
          const double z = frame.depth_m(u0 + u, v0 + v);
          const Eigen::Vector3d x(u, v, 1);
          if (std::isnan(z) || (pass > 0 && std::abs(1 / z - x.dot(plane.inverse_depth)) > limit)) continue;
          a += x * x.transpose();
          b += x / z;
          count += 1;
        }
      if (count < 0.5 * kWindow_px * kWindow_px) return false;
      plane.inverse_depth = a.ldlt().solve(b);
      limit = kMaxResidualShare;
    }
    measure_residuals(frame, u0, v0, plane);
    return plane.z_m > 0 && plane.rms_m < std::max(kMaxRms_m, 0.5 * kMaxResidualShare * plane.z_m * plane.z_m);
  }

  static void measure_residuals(const RgbdFrame& frame, int u0, int v0, Plane& plane) {
    double sum_sq = 0, sum_next = 0, pairs_sq = 0, count = 0, valid = 0;
    const auto residual = [&](int u, int v) {
      const double z = frame.depth_m(u0 + u, v0 + v);
      return z - 1 / plane.inverse_depth.dot(Eigen::Vector3d(u, v, 1));
    };
    for (int v = 0; v < kWindow_px; ++v)
      for (int u = 0; u < kWindow_px; ++u) {
        const double r = residual(u, v);
        if (std::isnan(r)) continue;
        valid += 1;
        sum_sq += r * r;
        count += 1;
        const double next = u + 1 < kWindow_px ? residual(u + 1, v) : std::nan("");
        if (std::isnan(next)) continue;
        sum_next += r * next;
        pairs_sq += 0.5 * (r * r + next * next);
      }
    const double middle = 0.5 * (kWindow_px - 1);
    plane.z_m = 1 / plane.inverse_depth.dot(Eigen::Vector3d(middle, middle, 1));
    plane.rms_m = std::sqrt(sum_sq / count);
    plane.correlation = pairs_sq > 0 ? sum_next / pairs_sq : std::nan("");
    plane.valid_share = valid / (kWindow_px * kWindow_px);
    plane.angle_deg = incidence_deg(frame.camera, u0 + middle, v0 + middle, plane);
  }

  // The plane n . p = 1 has 1 / z = n_x (u - cx) / fx + n_y (v - cy) / fy + n_z.
  static double incidence_deg(const Camera& camera, double u, double v, const Plane& plane) {
    Eigen::Vector3d normal(plane.inverse_depth.x() * camera.fx, plane.inverse_depth.y() * camera.fy, 0);
    const Eigen::Vector3d ray = camera.unproject(u, v, 1);
    normal.z() = 1 / plane.z_m - normal.x() * ray.x() - normal.y() * ray.y();
    return std::acos(std::clamp(std::abs(normal.normalized().dot(ray.normalized())), 0.0, 1.0)) * 180 /
           std::numbers::pi;
  }

  void add_windows(const RgbdFrame& frame) {
    for (int v0 = 0; v0 + kWindow_px <= frame.depth_m.height(); v0 += kWindow_px / 2)
      for (int u0 = 0; u0 + kWindow_px <= frame.depth_m.width(); u0 += kWindow_px / 2) {
        Plane plane;
        if (!fit_plane(frame, u0, v0, plane)) continue;
        const int angle = bin_of(kAngles_deg, plane.angle_deg);
        if (angle < 0) continue;
        HoleCount& holes = by_angle_[static_cast<std::size_t>(angle)];
        holes.pixels += kWindow_px * kWindow_px;
        holes.holes += (1 - plane.valid_share) * kWindow_px * kWindow_px;
        if (plane.valid_share < 0.95) continue;
        noise_by_angle_[static_cast<std::size_t>(angle)].push_back(plane.rms_m / (plane.z_m * plane.z_m));
        const int range = bin_of(kRanges_m, plane.z_m);
        if (range < 0 || plane.angle_deg > 50) continue;
        noise_by_range_[static_cast<std::size_t>(range)].push_back(plane.rms_m);
        if (!std::isnan(plane.correlation)) correlation_.push_back(plane.correlation);
      }
  }

  // Fills each hole of a row with the farther of its two ends: the shadow of the projector lies on the background.
  static Image<float> fill_rows(const Image<float>& depth_m) {
    Image<float> filled = depth_m;
    for (int v = 0; v < filled.height(); ++v)
      for (int u = 0; u < filled.width();) {
        int end = u;
        while (end < filled.width() && std::isnan(filled(end, v))) ++end;
        if (end > u) {
          const float left = u > 0 ? filled(u - 1, v) : 0;
          const float right = end < filled.width() ? filled(end, v) : 0;
          for (int i = u; i < end; ++i) filled(i, v) = std::max(left, right);
        }
        u = end + 1;
      }
    return filled;
  }

  static bool is_edge(const Image<float>& filled, int u, int v) {
    const float z = filled(u, v);
    for (const auto& [du, dv] : {std::pair{1, 0}, {0, 1}}) {
      if (!filled.contains(u + du, v + dv)) continue;
      const float other = filled(u + du, v + dv);
      if (std::abs(other - z) > 0.03F * std::max(z, other)) return true;
    }
    return false;
  }

  void add_hole_places(const RgbdFrame& frame) {
    const Image<float> filled = fill_rows(frame.depth_m);
    Image<int> distance(filled.width(), filled.height(), 100);
    for (int v = 0; v < filled.height(); ++v)
      for (int u = 0; u < filled.width(); ++u)
        if (is_edge(filled, u, v)) distance(u, v) = 0;
    const auto relax = [&](int u, int v, int du, int dv) {
      if (distance.contains(u + du, v + dv)) distance(u, v) = std::min(distance(u, v), distance(u + du, v + dv) + 1);
    };
    for (int v = 0; v < filled.height(); ++v)
      for (int u = 0; u < filled.width(); ++u) {
        relax(u, v, -1, 0);
        relax(u, v, 0, -1);
      }
    for (int v = filled.height() - 1; v >= 0; --v)
      for (int u = filled.width() - 1; u >= 0; --u) {
        relax(u, v, 1, 0);
        relax(u, v, 0, 1);
        const bool is_hole = std::isnan(frame.depth_m(u, v));
        const int edge = bin_of(kEdgeDistances_px, distance(u, v));
        if (edge >= 0) by_edge_[static_cast<std::size_t>(edge)].add(is_hole);
        const Rgb8 c = frame.color(u, v);
        const int brightness = bin_of(kBrightness, 0.299 * c.r + 0.587 * c.g + 0.114 * c.b);
        if (brightness >= 0) by_brightness_[static_cast<std::size_t>(brightness)].add(is_hole);
      }
  }

  std::array<std::vector<double>, kRanges_m.size() - 1> noise_by_range_;
  std::array<std::vector<double>, kAngles_deg.size() - 1> noise_by_angle_;
  std::vector<double> correlation_;
  HoleCount all_;
  std::array<HoleCount, kAngles_deg.size() - 1> by_angle_;
  std::array<HoleCount, kEdgeDistances_px.size() - 1> by_edge_;
  std::array<HoleCount, kBrightness.size() - 1> by_brightness_;
};

}  // namespace resight
