// SPDX-License-Identifier: Apache-2.0
#include "resight/sensor/depth_sensor.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <string>

namespace resight {
namespace {

constexpr DepthNoise with_axial(double constant_m, double quadratic_per_m) {
  DepthNoise noise;
  noise.constant_m = constant_m;
  noise.quadratic_per_m = quadratic_per_m;
  noise.nearest_m = 0;
  return noise;
}

/// Disparities that err by s px make depth err by z^2 s / (f B): focal length f (px), baseline B (m). s is 0.08 px; the
/// constant is that of a fit to a D435 (Ahn et al. 2019).
constexpr DepthNoise stereo_noise(double focal_px, double baseline_m) {
  return with_axial(0.001063, 0.08 / (focal_px * baseline_m));
}

// No source gives other models of the lateral noise and of the angle, so those of the Kinect v1 hold for all.
constexpr std::array<DepthSensor, 4> kSensors{{
    {"structured-light", DepthNoise{}, "Kinect v1: Nguyen et al. 2012"},
    {"active-stereo", stereo_noise(424, 0.050), "RealSense D435, 848 px wide, 90 deg: Intel, Tuning Depth Cameras"},
    {"active-stereo-d415", stereo_noise(1004, 0.055), "RealSense D415, 1280 px wide, 65 deg: the same"},
    // 1 mm at 1 m, 3.6 mm at 3 m.
    {"time-of-flight", with_axial(0.000675, 0.000325), "Azure Kinect: Tolgyessy et al. 2021, as in BlenderProc"},
}};

struct CameraWord {
  std::string_view word;  ///< In lower case.
  std::string_view sensor;
};

/// In the order in which they count: cameras, then drivers and what they call their topics.
constexpr std::array<CameraWord, 29> kWords{{
    {"sr300", "structured-light"},
    {"sr305", "structured-light"},
    {"d405", "active-stereo"},
    {"d415", "active-stereo-d415"},
    {"d435", "active-stereo"},
    {"d455", "active-stereo"},
    {"l515", "time-of-flight"},
    {"azure", "time-of-flight"},
    {"kinect2", "time-of-flight"},
    {"kinect_v2", "time-of-flight"},
    {"kinect v2", "time-of-flight"},
    {"kinect_one", "time-of-flight"},
    {"kinect one", "time-of-flight"},
    {"femto", "time-of-flight"},
    {"flexx", "time-of-flight"},
    {"kinect1", "structured-light"},
    {"kinect_v1", "structured-light"},
    {"kinect v1", "structured-light"},
    {"xtion", "structured-light"},
    {"astra", "structured-light"},
    {"k4a", "time-of-flight"},
    {"royale", "time-of-flight"},
    {"realsense", "active-stereo"},
    {"aligned_depth_to_color", "active-stereo"},
    {"/device_0/sensor_", "active-stereo"},
    {"openni", "structured-light"},
    {"freenect", "structured-light"},
    {"primesense", "structured-light"},
    {"kinect", "structured-light"},
}};

}  // namespace

std::span<const DepthSensor> depth_sensors() { return kSensors; }

const DepthSensor* find_depth_sensor(std::string_view name) {
  const auto it = std::ranges::find(kSensors, name, &DepthSensor::name);
  return it == kSensors.end() ? nullptr : &*it;
}

const DepthSensor* detect_depth_sensor(std::string_view text) {
  std::string lower(text);
  std::ranges::transform(lower, lower.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  for (const CameraWord& known : kWords)
    if (lower.find(known.word) != lower.npos) return find_depth_sensor(known.sensor);
  return nullptr;
}

}  // namespace resight
