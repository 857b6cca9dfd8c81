// SPDX-License-Identifier: Apache-2.0
#include "resight/sensor/noise_model.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "resight/core/check.hpp"
#include "resight/core/parallel.hpp"

namespace resight {
namespace {

constexpr double kMaxAngle_rad = 85.0 / 180.0 * std::numbers::pi;
constexpr int kRowsPerTask = 32;

/// DepthNoise, as a template for the double of noise_sigma() and the float of whole images.
template <typename T>
struct NoiseModel {
  explicit NoiseModel(const DepthNoise& noise)
      : constant_m(static_cast<T>(noise.constant_m)),
        quadratic_per_m(static_cast<T>(noise.quadratic_per_m)),
        nearest_m(static_cast<T>(noise.nearest_m)),
        grazing(static_cast<T>(noise.grazing)),
        lateral_px(static_cast<T>(noise.lateral_px)),
        lateral_grazing_px(static_cast<T>(noise.lateral_grazing_px)) {}
  T constant_m, quadratic_per_m, nearest_m, grazing, lateral_px, lateral_grazing_px;

  [[nodiscard]] T lateral_sigma_m(T z_m, T ratio, T focal_px) const {
    return (lateral_px + lateral_grazing_px * ratio) * z_m / focal_px;
  }
  [[nodiscard]] T axial_sigma_m(T z_m, T ratio) const {
    const T from_near = z_m - nearest_m;
    return constant_m + quadratic_per_m * from_near * from_near + grazing / std::sqrt(z_m) * ratio * ratio;
  }
};

/// arccos on [0, 1] with an error of about 1e-7 (Abramowitz & Stegun 4.4.46). The function of libm, called per pixel,
/// takes ten times as long.
inline float arc_cosine(float c) {
  float p = -0.0012624911F;
  p = p * c + 0.0066700901F;
  p = p * c - 0.0170881256F;
  p = p * c + 0.0308918810F;
  p = p * c - 0.0501743046F;
  p = p * c + 0.0889789874F;
  p = p * c - 0.2145988016F;
  p = p * c + 1.5707963050F;
  return p * std::sqrt(1.0F - c);
}

/// theta / (pi/2 - theta) of the clipped angle with cosine `c`.
inline float angle_ratio(float c) {
  constexpr auto kHalfPi = std::numbers::pi_v<float> / 2;
  constexpr auto kMaxAngle = static_cast<float>(kMaxAngle_rad);
  const float angle = arc_cosine(c > 1.0F ? 1.0F : c);
  const float clipped = angle < kMaxAngle ? angle : kMaxAngle;  // NaN (no normal) becomes the largest angle
  return clipped / (kHalfPi - clipped);
}

/// Computes one row. Passes pointers as parameters, because compilers honour __restrict only there; otherwise the loop
/// is not vectorised. `trust` is 1, or NaN if there are no normals.
void model_row(const float* __restrict x, const float* __restrict y, const float* __restrict z,
               const float* __restrict nx, const float* __restrict ny, const float* __restrict nz, int width,
               float trust, float focal_px, const NoiseModel<float> noise, float* __restrict lateral_m,
               float* __restrict axial_m, float* __restrict normal_m) {
  for (int u = 0; u < width; ++u) {
    const float along_ray = std::abs(nx[u] * x[u] + ny[u] * y[u] + nz[u] * z[u]);
    const float range = std::sqrt(x[u] * x[u] + y[u] * y[u] + z[u] * z[u]);
    const float cosine = trust * along_ray / range;
    const float ratio = angle_ratio(cosine);
    const float lateral = noise.lateral_sigma_m(z[u], ratio, focal_px);
    const float axial = noise.axial_sigma_m(z[u], ratio);
    const float cosine_sq = cosine < 1.0F ? cosine * cosine : 1.0F;  // NaN (no normal) becomes 1.
    lateral_m[u] = lateral;
    axial_m[u] = axial;
    normal_m[u] = std::sqrt(axial * axial * cosine_sq + lateral * lateral * (1.0F - cosine_sq));
  }
}

}  // namespace

NoiseSigma noise_sigma(const DepthNoise& noise, double z_m, double angle_rad, double focal_px) {
  check_positive("noise_sigma: z_m", z_m);
  check_not_negative("noise_sigma: angle_rad", angle_rad);
  check_positive("noise_sigma: focal_px", focal_px);
  const double angle = std::min(angle_rad, kMaxAngle_rad);
  const double ratio = angle / (std::numbers::pi / 2 - angle);
  const NoiseModel<double> sigma(noise);
  return {sigma.lateral_sigma_m(z_m, ratio, focal_px), sigma.axial_sigma_m(z_m, ratio)};
}

double axial_noise_m(const DepthNoise& noise, double z_m) {
  check_positive("axial_noise_m: z_m", z_m);
  return NoiseModel<double>(noise).axial_sigma_m(z_m, 0);
}

NoiseSigma nguyen_noise(double z_m, double angle_rad, double focal_px) {
  return noise_sigma(DepthNoise{}, z_m, angle_rad, focal_px);
}

NoiseImages model_noise(const OrganizedCloud& cloud_in_camera, const Camera& camera, int num_threads) {
  require(camera.is_valid(), "model_noise: invalid intrinsics (size and focal lengths must be positive and finite)");
  const int width = cloud_in_camera.width();
  const int height = cloud_in_camera.height();
  require(width == camera.width && height == camera.height,
          "model_noise: the cloud must have the size of the camera image");
  const auto focal_px = static_cast<float>((camera.fx + camera.fy) / 2);
  NoiseImages noise{Image<float>(width, height), Image<float>(width, height), Image<float>(width, height)};
  const OrganizedCloud& c = cloud_in_camera;
  const NoiseModel<float> model(camera.noise);
  const bool has_normals = !c.nx.empty();
  const float trust = has_normals ? 1.0F : std::numeric_limits<float>::quiet_NaN();
  const auto normals = [&](const Image<float>& image) -> const Image<float>& { return has_normals ? image : c.z; };
  parallel_for_blocks(
      static_cast<std::size_t>(height), kRowsPerTask, num_threads, [&](std::size_t first, std::size_t last) {
        for (int v = static_cast<int>(first); v < static_cast<int>(last); ++v)
          model_row(c.x.row(v).data(), c.y.row(v).data(), c.z.row(v).data(), normals(c.nx).row(v).data(),
                    normals(c.ny).row(v).data(), normals(c.nz).row(v).data(), width, trust, focal_px, model,
                    noise.lateral_m.row(v).data(), noise.axial_m.row(v).data(), noise.normal_m.row(v).data());
      });
  return noise;
}

}  // namespace resight
