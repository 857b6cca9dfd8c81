// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "resight/geometry/camera.hpp"
#include "resight/sensor/organized_cloud.hpp"

namespace resight {

/// Standard deviations of one measurement in metres.
struct NoiseSigma {
  double lateral_m = 0;
  double axial_m = 0;
};

/// Noise of a measurement by the noise model of its camera. `z_m` is the depth, `angle_rad` the angle between surface
/// normal and viewing ray (>= 0, clipped at 85 deg), `focal_px` the focal length.
[[nodiscard]] NoiseSigma noise_sigma(const DepthNoise& noise, double z_m, double angle_rad, double focal_px);
/// Axial noise of a surface seen head-on, metres.
[[nodiscard]] double axial_noise_m(const DepthNoise& noise, double z_m);
/// Noise of a Kinect v1 (paper [19]):
/// sigma_L = (0.8 + 0.035 theta/(pi/2 - theta)) z/f;
/// sigma_z = 0.0012 + 0.0019 (z - 0.4)^2 + 0.0001/sqrt(z) * theta^2/(pi/2 - theta)^2.
[[nodiscard]] NoiseSigma nguyen_noise(double z_m, double angle_rad, double focal_px);

/// Noise of each pixel of a cloud in metres.
struct NoiseImages {
  Image<float> lateral_m;
  Image<float> axial_m;
  Image<float> normal_m;  ///< Along the normal: sqrt((axial cos theta)^2 + (lateral sin theta)^2). No normal: axial.
};

/// Evaluates noise_sigma() for each point by the noise model of the camera, with the mean of both focal lengths. NaN
/// where there is no point. A point without a normal gets the largest value, that of 85 deg, so that any other point in
/// its voxel is preferred.
[[nodiscard]] NoiseImages model_noise(const OrganizedCloud& cloud_in_camera, const Camera& camera, int num_threads = 1);

}  // namespace resight
