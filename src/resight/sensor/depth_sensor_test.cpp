// SPDX-License-Identifier: Apache-2.0
#include "resight/sensor/depth_sensor.hpp"

#include <gtest/gtest.h>

#include <string>

#include "resight/sensor/noise_model.hpp"

namespace resight {
namespace {

std::string name_of(const DepthSensor* sensor) { return sensor == nullptr ? "" : std::string(sensor->name); }

TEST(DepthSensor, AreFoundByTheirNames) {
  ASSERT_EQ(depth_sensors().size(), 4U);
  for (const DepthSensor& sensor : depth_sensors()) {
    EXPECT_EQ(find_depth_sensor(sensor.name), &sensor);
    EXPECT_FALSE(sensor.source.empty());
  }
  EXPECT_EQ(find_depth_sensor("sonar"), nullptr);
}

TEST(DepthSensor, AreRecognisedByWhatRecordingsSay) {
  EXPECT_EQ(name_of(detect_depth_sensor("Name\nIntel RealSense D435I\n/device_0/sensor_0/Depth_0/image/data")),
            "active-stereo");
  EXPECT_EQ(name_of(detect_depth_sensor("Name\nIntel RealSense D415")), "active-stereo-d415");
  EXPECT_EQ(name_of(detect_depth_sensor("Name\nIntel RealSense SR300")), "structured-light");
  EXPECT_EQ(name_of(detect_depth_sensor("Azure Kinect")), "time-of-flight");
  EXPECT_EQ(name_of(detect_depth_sensor("/kinect/depth/image")), "structured-light");
  EXPECT_EQ(name_of(detect_depth_sensor("/camera/aligned_depth_to_color/image_raw")), "active-stereo");
  EXPECT_EQ(name_of(detect_depth_sensor("/k4a/depth_to_rgb/image_raw")), "time-of-flight");
  EXPECT_EQ(name_of(detect_depth_sensor("/kinect2/qhd/image_depth_rect")), "time-of-flight");
  EXPECT_EQ(name_of(detect_depth_sensor("/openni/depth_registered/image")), "structured-light");
  EXPECT_EQ(name_of(detect_depth_sensor("/camera/depth_registered/image_raw")), "");
  EXPECT_EQ(name_of(detect_depth_sensor("/autofocus")), "");
}

// The published numbers.
TEST(DepthSensor, HaveTheNoiseOfTheirSources) {
  const auto axial_mm = [](std::string_view name, double z_m) {
    return 1000 * axial_noise_m(find_depth_sensor(name)->noise, z_m);
  };
  for (const double z_m : {0.5, 1.0, 3.0})
    EXPECT_EQ(axial_mm("structured-light", z_m), 1000 * nguyen_noise(z_m, 0, 525).axial_m);
  EXPECT_NEAR(axial_mm("active-stereo", 1) - axial_mm("active-stereo", 1e-6), 0.08 / (424 * 0.05) * 1000, 1e-3);
  EXPECT_NEAR(axial_mm("active-stereo", 2), 1.063 + 4 * 3.774, 0.01);
  EXPECT_NEAR(axial_mm("active-stereo-d415", 2), 1.063 + 4 * 1.449, 0.01);
  EXPECT_NEAR(axial_mm("time-of-flight", 1), 1.0, 0.01);
  EXPECT_NEAR(axial_mm("time-of-flight", 3), 3.6, 0.01);
}

TEST(DepthSensor, TheNoiseOfAViewIsThatOfItsCamera) {
  Camera camera = make_kinect_camera();
  const Image<float> depth_m(camera.width, camera.height, 2.0F);
  const NoiseImages structured = model_noise(back_project(camera, depth_m), camera);
  camera.noise = find_depth_sensor("time-of-flight")->noise;
  const NoiseImages of_time = model_noise(back_project(camera, depth_m), camera);
  // Without normals, the noise is that of the largest angle; the dependence on the angle is the same.
  EXPECT_NEAR(structured.axial_m(320, 240) - of_time.axial_m(320, 240),
              nguyen_noise(2, 0, 525).axial_m - axial_noise_m(camera.noise, 2), 1e-6);
  EXPECT_EQ(structured.lateral_m(320, 240), of_time.lateral_m(320, 240));
}

}  // namespace
}  // namespace resight
