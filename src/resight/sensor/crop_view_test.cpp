// SPDX-License-Identifier: Apache-2.0
#include "resight/sensor/crop_view.hpp"

#include <gtest/gtest.h>

#include <stdexcept>

namespace resight {
namespace {

// The value of each pixel identifies its place.
TrainingView make_view() {
  TrainingView view;
  view.frame = {.name = "v",
                .camera = {200, 150, 180, 190, 99.5, 74.5},
                .color = Image<Rgb8>(200, 150),
                .depth_m = Image<float>(200, 150),
                .world_from_camera = Rigid3::from_translation({1, 2, 3})};
  view.mask = Image<std::uint8_t>(200, 150);
  for (int v = 0; v < 150; ++v)
    for (int u = 0; u < 200; ++u) {
      view.frame.color(u, v) = {static_cast<std::uint8_t>(u), static_cast<std::uint8_t>(v), 0};
      view.frame.depth_m(u, v) = 1.0F + 0.001F * static_cast<float>(u) + 0.002F * static_cast<float>(v);
    }
  return view;
}

TEST(CropToObject, KeepsEveryPixelsRayColourAndDepth) {
  TrainingView view = make_view();
  view.mask(60, 40) = 1;
  view.mask(90, 70) = 255;
  const TrainingView part = crop_to_object(view, 10);
  ASSERT_TRUE(check_frame(part.frame).ok());
  ASSERT_EQ(part.mask.width(), 51);
  ASSERT_EQ(part.mask.height(), 51);
  for (int v = 0; v < 51; ++v)
    for (int u = 0; u < 51; ++u) {
      ASSERT_EQ(part.frame.color(u, v), view.frame.color(u + 50, v + 30));
      ASSERT_EQ(part.frame.depth_m(u, v), view.frame.depth_m(u + 50, v + 30));
      ASSERT_EQ(part.mask(u, v), view.mask(u + 50, v + 30));
      ASSERT_LT((part.frame.camera.unproject(u, v, 1.5) - view.frame.camera.unproject(u + 50, v + 30, 1.5)).norm(),
                1e-12);
    }
  EXPECT_EQ(part.frame.name, "v");
  EXPECT_EQ(part.frame.world_from_camera.translation, view.frame.world_from_camera.translation);
}

TEST(CropToObject, StaysWithinTheImage) {
  TrainingView view = make_view();
  view.mask(0, 149) = 1;
  const TrainingView corner = crop_to_object(view, 20);
  EXPECT_EQ(corner.mask.width(), 21);
  EXPECT_EQ(corner.mask.height(), 21);
  EXPECT_EQ(corner.mask(0, 20), 1);
  EXPECT_EQ(crop_to_object(view, 1000).frame.color, view.frame.color);
}

TEST(CropToObject, OfAnEmptyMaskIsEmpty) {
  const TrainingView part = crop_to_object(make_view(), 10);
  EXPECT_TRUE(part.mask.empty());
  EXPECT_TRUE(part.frame.color.empty());
  EXPECT_THROW((void)crop_to_object(make_view(), -1), std::invalid_argument);
}

}  // namespace
}  // namespace resight
