// SPDX-License-Identifier: Apache-2.0
#include "resight/recordings/transform_buffer.hpp"

#include <gtest/gtest.h>

namespace resight {
namespace {

StampedTransform moved(const std::string& parent, const std::string& child, double time_s, double x) {
  return {static_cast<std::int64_t>(time_s * 1e9), parent, child, Rigid3::from_translation({x, 0, 0})};
}

TransformBuffer make_buffer() {
  TransformBuffer buffer;
  buffer.add(moved("map", "odom", 1, 10), false);
  buffer.add(moved("map", "odom", 2, 10), false);
  buffer.add(moved("odom", "base", 2, 2), false);  // out of order
  buffer.add(moved("odom", "base", 1, 1), false);
  buffer.add(moved("base", "camera", 0, 0.5), true);
  buffer.add(moved("base", "depth", 0, 0.25), true);
  buffer.finish();
  return buffer;
}

TEST(TransformBuffer, InterpolatesAlongThePath) {
  const TransformBuffer buffer = make_buffer();
  const auto map_from_camera = buffer.find("map", "camera", 1500000000, 2);
  ASSERT_TRUE(map_from_camera.has_value());
  EXPECT_NEAR(map_from_camera->translation.x(), 10 + 1.5 + 0.5, 1e-12);
  const auto camera_from_map = buffer.find("camera", "map", 1500000000, 2);
  ASSERT_TRUE(camera_from_map.has_value());
  EXPECT_NEAR((*camera_from_map * *map_from_camera).translation.norm(), 0, 1e-12);
  EXPECT_NEAR(buffer.find("camera", "depth", 0, 1)->translation.x(), -0.25, 1e-12) << "of two branches";
}

TEST(TransformBuffer, GapsAndUnknownFramesHaveNoTransform) {
  const TransformBuffer buffer = make_buffer();
  EXPECT_FALSE(buffer.find("map", "camera", 1500000000, 0.5).has_value()) << "the neighbours are 1 s apart";
  EXPECT_TRUE(buffer.find("map", "camera", 2000000000, 0.5).has_value()) << "robots stop to look";
  EXPECT_TRUE(buffer.find("map", "camera", 1005000000, 0.5).has_value());
  EXPECT_FALSE(buffer.find("map", "camera", 9000000000, 1).has_value()) << "long after the last one";
  EXPECT_TRUE(buffer.find("map", "camera", 2100000000, 1).has_value());
  EXPECT_FALSE(buffer.find("map", "nothing", 1500000000, 2).has_value());
  EXPECT_TRUE(buffer.find("nothing", "nothing", 0, 1).has_value());
}

TEST(TransformBuffer, Frames) {
  const TransformBuffer buffer = make_buffer();
  EXPECT_EQ(buffer.root_of("camera"), "map");
  EXPECT_EQ(buffer.root_of("nothing"), "nothing");
  EXPECT_TRUE(buffer.is_moving("camera"));
  EXPECT_FALSE(buffer.knows("nothing"));
  EXPECT_EQ(buffer.frames().size(), 5U);
}

// static_transform_publisher of ROS 1 repeats constants.
TEST(TransformBuffer, ConstantsThatAreRepeatedDoNotMove) {
  TransformBuffer buffer;
  for (const double time_s : {1.0, 2.0}) buffer.add(moved("a", "camera", time_s, 1), false);
  EXPECT_FALSE(buffer.is_moving("camera"));
  EXPECT_TRUE(buffer.moving_frames().empty());
  buffer.add(moved("a", "camera", 3, 1.00001), false);
  EXPECT_TRUE(buffer.is_moving("camera"));
}

TEST(TransformBuffer, LoopsEnd) {
  TransformBuffer buffer;
  buffer.add(moved("a", "b", 0, 1), true);
  buffer.add(moved("b", "a", 0, 1), true);
  buffer.finish();
  EXPECT_FALSE(buffer.find("c", "a", 0, 1).has_value());
  EXPECT_FALSE(buffer.root_of("a").empty());
}

}  // namespace
}  // namespace resight
