// SPDX-License-Identifier: Apache-2.0
#include "resight/simulation/realistic_recording.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace resight {
namespace {

double clamped_normal(Rng& rng, double sigma, double limit) { return std::clamp(sigma * rng.normal(), -limit, limit); }

DepthErrors draw_depth_errors(Rng& rng) {
  DepthErrors e;
  const double shift_px = rng.uniform(0.5, 2);
  const double direction_rad = rng.uniform(-std::numbers::pi, std::numbers::pi);
  e.shift_u_px = shift_px * std::cos(direction_rad);
  e.shift_v_px = shift_px * std::sin(direction_rad);
  e.lens.k1 = clamped_normal(rng, 0.003, 0.008);
  e.disparity_offset_px = clamped_normal(rng, 0.08, 0.2);
  e.disparity_noise_px = rng.uniform(0.055, 0.1);
  e.disparity_noise_cell_px = rng.uniform(5, 9);
  e.outline_noise_px = rng.uniform(0.4, 0.9);
  e.outline_noise_cell_px = rng.uniform(4, 7);
  e.edge_band_px = rng.uniform(3, 6);
  e.edge_loss = rng.uniform(0.5, 0.8);
  e.grazing_start_deg = rng.uniform(62, 74);
  e.highlight_loss = rng.uniform(0.5, 1.5);
  e.dark_loss = rng.uniform(0.6, 1);
  e.dark_level = rng.uniform(0.12, 0.28);
  e.hole_cell_px = rng.uniform(3, 5);
  return e;
}

ColorCamera draw_color_camera(Rng& rng) {
  ColorCamera c;
  c.exposure.metering = rng.uniform(0.6, 0.9);
  c.exposure.metering_target = rng.uniform(0.16, 0.34);
  c.exposure.white_balancing = rng.uniform(0.4, 0.8);
  c.exposure.red_gain = std::exp(clamped_normal(rng, 0.08, 0.16));
  c.exposure.blue_gain = std::exp(clamped_normal(rng, 0.1, 0.2));
  c.blur_px = rng.uniform(0.5, 0.8);
  c.motion_blur_px = rng.uniform(0.2, 1.2);
  c.mosaic = true;
  c.read_noise = rng.uniform(0.003, 0.008);
  c.shot_noise = rng.uniform(0.02, 0.05);
  c.noise_reduction = rng.uniform(4, 10);
  c.contrast = rng.uniform(0.2, 0.6);
  c.sharpening = rng.uniform(0.4, 1.4);
  c.saturation = rng.uniform(0.7, 1.2);
  c.jpeg_quality = 75 + static_cast<int>(rng.below(21));
  return c;
}

Lamp draw_lamp(Rng& rng, double side, const Eigen::Vector3d& color) {
  Lamp lamp;
  const double x_m = side * rng.uniform(0.4, 1.8);
  const double y_m = rng.uniform(-1.8, 1.2);
  lamp.position_in_world_m = {x_m, y_m, rng.uniform(2.1, 2.5)};
  lamp.intensity = rng.uniform(0.3, 0.75) * color;
  lamp.radius_m = rng.uniform(0.05, 0.3);
  return lamp;
}

}  // namespace

SensorOptions draw_sensor(Rng& rng) {
  SensorOptions sensor;
  sensor.lateral_noise = 0.3;  // the rest is correlated
  sensor.axial_noise = 0.2;
  sensor.max_incidence_deg = 86;
  sensor.edge_dropout = 0;  // edge_band_px instead
  sensor.gain_sigma = 0.06;
  sensor.white_balance_sigma = 0.015;
  sensor.depth_errors = draw_depth_errors(rng);
  sensor.color_camera = draw_color_camera(rng);
  return sensor;
}

ResidualDistortion draw_lens(Rng& rng) {
  ResidualDistortion lens;
  lens.k1 = clamped_normal(rng, 0.005, 0.01);
  lens.k2 = clamped_normal(rng, 0.003, 0.006);
  return lens;
}

Lighting draw_lighting(Rng& rng) {
  Lighting lighting;
  lighting.shadows = true;
  const double warmth = rng.uniform(0.1, 0.35);
  const double coldness = rng.uniform(0.05, 0.2);
  const double side = rng.uniform() < 0.5 ? -1 : 1;
  lighting.lamps.push_back(draw_lamp(rng, side, {1 + 0.5 * warmth, 1, 1 - warmth}));
  lighting.lamps.push_back(draw_lamp(rng, -side, {1 - coldness, 1, 1 + 0.5 * coldness}));
  lighting.ambient = rng.uniform(0.2, 0.4);
  lighting.ambient_color = {1 + rng.uniform(-0.05, 0.08), 1, 1};
  return lighting;
}

CameraDriftOptions draw_drift(Rng& rng) {
  CameraDriftOptions drift;
  drift.position_sigma_m = rng.uniform(0.002, 0.006);
  drift.rotation_sigma_deg = rng.uniform(0.1, 0.3);
  drift.correlation_views = rng.uniform(5, 12);
  drift.seed = rng.next();
  return drift;
}

}  // namespace resight
