// SPDX-License-Identifier: Apache-2.0
#include "resight/rendering/sensor_model.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "resight/core/check.hpp"
#include "resight/core/parallel.hpp"
#include "resight/core/random.hpp"
#include "resight/rendering/internal/depth_edges.hpp"
#include "resight/rendering/internal/depth_error_field.hpp"
#include "resight/sensor/noise_model.hpp"

namespace resight {
namespace {

constexpr float kMissing = std::numeric_limits<float>::quiet_NaN();
constexpr double kIncidenceRamp_deg = 10.0;
constexpr double kSelfShadowGap_m = 2e-3;
constexpr std::uint64_t kColorStream = 0xC0104ULL;  // Separates the random numbers of colour from those of depth.

double incidence_rad(const Eigen::Vector3f& normal, const Eigen::Vector3f& direction) {
  const double cosine = std::abs(normal.dot(direction)) / (normal.norm() * direction.norm());
  return std::acos(std::clamp(cosine, 0.0, 1.0));
}

// Whether a surface returns only part of the rays, as glass does.
bool swallows_rays(const RaycastScene& scene) {
  for (int i = 0; i < scene.num_instances(); ++i)
    if (scene.is_visible(i) && scene.material(i).depth_return < 1) return true;
  return false;
}

class DepthSensor {
 public:
  DepthSensor(const RaycastScene& scene, const Camera& camera, const Rigid3& world_from_camera,
              const RenderedView& view, const SensorOptions& options, std::uint64_t seed)
      : scene_(scene),
        camera_(camera),
        view_(view),
        options_(options),
        world_from_camera_(world_from_camera),
        projector_((world_from_camera * Eigen::Vector3d(options.baseline_m, 0, 0)).cast<float>()) {
    if (options.depth_errors || swallows_rays(scene))
      errors_.emplace(options.depth_errors.value_or(DepthErrors{}), camera, view, seed);
  }

  void sense_row(int v, Rng rng, std::span<float> depth_m) const {
    std::vector<int> columns;  // Columns of pixels that may have a return.
    std::vector<Pixel> measured;
    std::vector<Ray> rays;
    for (int u = 0; u < camera_.width; ++u) {
      const Eigen::Vector2d ideal = errors_ ? errors_->measured_pixel(u, v) : Eigen::Vector2d(u, v);
      const std::optional<Pixel> pixel = camera_.pixel_at(ideal);
      if (!pixel || std::isnan(view_.depth_m(pixel->u, pixel->v)) || is_lost_at_edge(pixel->u, pixel->v, rng)) continue;
      columns.push_back(u);
      measured.push_back(*pixel);
      rays.push_back(perturbed_ray(*pixel, ideal.cast<float>(), rng));
    }
    std::vector<RayHit> hits(rays.size());
    scene_.cast(rays, hits);
    for (std::size_t i = 0; i < rays.size(); ++i) {
      if (errors_ && is_lost(columns[i], v, measured[i], rays[i], hits[i])) continue;
      const double z = measure(columns[i], v, rays[i], hits[i], rng);
      if (z >= options_.min_depth_m && z <= options_.max_depth_m)  // false for NaN
        depth_m[columns[i]] = static_cast<float>(z);
    }
  }

 private:
  bool is_lost(int u, int v, const Pixel& measured, const Ray& ray, const RayHit& hit) const {
    if (!hit.has_hit()) return true;
    SensedSurface surface;
    surface.incidence_deg = incidence_rad(scene_.face_normal(hit), ray.direction) * 180 / std::numbers::pi;
    surface.material = scene_.material(hit.instance);
    surface.brightness = scene_.color(hit, hit.distance / static_cast<float>(camera_.fx)).mean() / 255;
    return errors_->is_lost(u, v, measured, surface, options_.max_incidence_deg);
  }

  bool is_lost_at_edge(int u, int v, Rng& rng) const {
    return options_.edge_dropout > 0 && is_beside_depth_edge(view_.depth_m, u, v) &&
           rng.uniform() < options_.edge_dropout;
  }

  // Measured depth; NaN means no return.
  double measure(int u, int v, const Ray& ray, const RayHit& hit, Rng& rng) const {
    if (!hit.has_hit()) return kMissing;
    const Eigen::Vector3f normal = scene_.face_normal(hit);
    const double angle = incidence_rad(normal, ray.direction);
    if (!reflects(angle, rng)) return kMissing;
    if (options_.projector_shadow && !is_lit(ray.origin + hit.distance * ray.direction, normal, ray.direction))
      return kMissing;
    double z = hit.distance;
    if (options_.axial_noise > 0) z += options_.axial_noise * nguyen_noise(z, angle, camera_.fx).axial_m * rng.normal();
    const double focal_baseline = camera_.fx * options_.baseline_m;
    if (errors_) z = focal_baseline / std::max(1e-6, focal_baseline / z + errors_->disparity_error_px(u, v));
    if (options_.disparity_step_px > 0) z = quantize_depth(z, focal_baseline, options_.disparity_step_px);
    return z;
  }

  Ray perturbed_ray(const Pixel& pixel, Eigen::Vector2f position, Rng& rng) const {
    if (options_.lateral_noise > 0) {
      const double z = view_.depth_m(pixel.u, pixel.v);
      const Eigen::Vector3f direction = camera_.unproject(pixel.u, pixel.v, 1.0).cast<float>();
      const double angle = incidence_rad(view_.normals_in_camera(pixel.u, pixel.v), direction);
      const double sigma_px = options_.lateral_noise * nguyen_noise(z, angle, camera_.fx).lateral_m * camera_.fx / z;
      position.x() += static_cast<float>(sigma_px * rng.normal());
      position.y() += static_cast<float>(sigma_px * rng.normal());
    }
    return pixel_ray(camera_, world_from_camera_, position.x(), position.y());
  }

  bool reflects(double angle_rad, Rng& rng) const {
    if (options_.max_incidence_deg >= 90) return true;
    const double margin_deg = options_.max_incidence_deg - angle_rad * 180 / std::numbers::pi;
    if (options_.depth_errors && options_.depth_errors->grazing_start_deg < 90)
      return margin_deg > 0;  // is_lost() thins out
    if (margin_deg >= kIncidenceRamp_deg) return true;
    return margin_deg > 0 && rng.uniform() < margin_deg / kIncidenceRamp_deg;
  }

  bool is_lit(const Eigen::Vector3f& p, const Eigen::Vector3f& normal, const Eigen::Vector3f& view_direction) const {
    const Eigen::Vector3f to_projector = projector_ - p;
    if (normal.dot(to_projector) * normal.dot(-view_direction) <= 0) return false;  // lit only from behind
    return !scene_.is_blocked({p, to_projector}, static_cast<float>(kSelfShadowGap_m) / to_projector.norm(), 1.0F);
  }

  const RaycastScene& scene_;
  const Camera& camera_;
  const RenderedView& view_;
  const SensorOptions& options_;
  Rigid3f world_from_camera_;
  Eigen::Vector3f projector_;
  std::optional<DepthErrorField> errors_;
};

// Factors of the exposure and white balance of a view.
std::array<float, 3> draw_gains(const SensorOptions& options, std::uint64_t color_seed) {
  Rng view_rng = Rng::stream(color_seed, ~0ULL);
  const double gain = std::exp(options.gain_sigma * view_rng.normal());
  std::array<float, 3> gains{};
  for (float& g : gains) g = static_cast<float>(gain * std::exp(options.white_balance_sigma * view_rng.normal()));
  return gains;
}

}  // namespace

void SensorOptions::check() const {
  check_not_negative("SensorOptions.lateral_noise", lateral_noise);
  check_not_negative("SensorOptions.axial_noise", axial_noise);
  check_not_negative("SensorOptions.disparity_step_px", disparity_step_px);
  check_positive("SensorOptions.baseline_m", baseline_m);
  check_in_range("SensorOptions.max_incidence_deg", max_incidence_deg, 1, 90);
  check_in_range("SensorOptions.edge_dropout", edge_dropout, 0, 1);
  check_positive("SensorOptions.min_depth_m", min_depth_m);
  require(max_depth_m > min_depth_m, "SensorOptions.max_depth_m must be larger than min_depth_m");
  check_not_negative("SensorOptions.color_noise", color_noise);
  check_in_range("SensorOptions.gain_sigma", gain_sigma, 0, 2);  // more would overflow
  check_in_range("SensorOptions.white_balance_sigma", white_balance_sigma, 0, 2);
  if (depth_errors) depth_errors->check();
  if (color_camera) color_camera->check();
}

double quantize_depth(double depth_m, double focal_baseline, double disparity_step_px) {
  const double steps = std::round(focal_baseline / depth_m / disparity_step_px);
  return steps > 0 ? focal_baseline / (steps * disparity_step_px) : std::numeric_limits<double>::quiet_NaN();
}

Image<float> sense_depth(const RaycastScene& scene, const Camera& camera, const Rigid3& world_from_camera,
                         const RenderedView& view, const SensorOptions& options, std::uint64_t seed, int num_threads) {
  options.check();
  require(view.depth_m.width() == camera.width && view.depth_m.height() == camera.height,
          "sense_depth: the view must have the size of the camera image");
  if (options.noise_free) return view.depth_m;
  Image<float> depth_m(camera.width, camera.height, kMissing);
  const DepthSensor sensor(scene, camera, world_from_camera, view, options, seed);
  parallel_for(static_cast<std::size_t>(camera.height), num_threads, [&](std::size_t v) {
    sensor.sense_row(static_cast<int>(v), Rng::stream(seed, v), depth_m.row(static_cast<int>(v)));
  });
  return depth_m;
}

Image<Rgb8> sense_color(const Image<Rgb8>& ideal, const SensorOptions& options, std::uint64_t seed, int num_threads) {
  options.check();
  if (options.noise_free) return ideal;
  const std::uint64_t color_seed = seed ^ (kColorStream << 32U);
  const std::array<float, 3> gains = draw_gains(options, color_seed);
  Image<Rgb8> sensed = ideal;
  parallel_for(static_cast<std::size_t>(ideal.height()), num_threads, [&](std::size_t v) {
    Rng rng = Rng::stream(color_seed, v);
    const auto sense = [&](std::uint8_t value, float channel_gain) {
      const float noise = options.color_noise > 0 ? static_cast<float>(options.color_noise * rng.normal()) : 0.0F;
      return static_cast<std::uint8_t>(
          std::clamp(static_cast<float>(value) * channel_gain + noise + 0.5F, 0.0F, 255.0F));
    };
    for (Rgb8& c : sensed.row(static_cast<int>(v))) {
      c.r = sense(c.r, gains[0]);
      c.g = sense(c.g, gains[1]);
      c.b = sense(c.b, gains[2]);
    }
  });
  return sensed;
}

Image<Rgb8> sense_color(const RenderedView& view, const SensorOptions& options, std::uint64_t seed, int num_threads) {
  if (options.noise_free || !options.color_camera) return sense_color(view.color, options, seed, num_threads);
  options.check();
  require(!view.light.empty(), "sense_color: options.color_camera needs a view with linear light");
  const std::uint64_t color_seed = seed ^ (kColorStream << 32U);
  const std::array<float, 3> gains = draw_gains(options, color_seed);
  return develop_color(view.light, *options.color_camera, {gains[0], gains[1], gains[2]}, color_seed, num_threads);
}

}  // namespace resight
