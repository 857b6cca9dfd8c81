// SPDX-License-Identifier: Apache-2.0
#include "resight/training/equal_objects.hpp"

#include <gmock/gmock.h>

namespace resight {
namespace {

// A plate of 10 x 10 cm, striped along one side.
ObjectModel make_plate(Rgb8 stripe, float height_m = 0) {
  ObjectModel model;
  model.diameter_m = 0.1414F;
  for (int i = 0; i < 34; ++i)
    for (int j = 0; j < 34; ++j) {
      model.surface.points.emplace_back(0.003F * static_cast<float>(i), 0.003F * static_cast<float>(j), height_m);
      model.surface.colors.push_back(i % 4 == 0 ? stripe : Rgb8{200, 200, 190});
    }
  return model;
}

TEST(FindEqualObjects, OfOneShapeAndColor) {
  ModelLibrary library;
  library.objects = {make_plate({200, 30, 30}), make_plate({30, 30, 200}), make_plate({190, 40, 30}),
                     make_plate({200, 30, 30}, 0.02F)};
  EXPECT_THAT(find_equal_objects(library), testing::ElementsAre(testing::Pair(0, 2)));
}

TEST(FindEqualObjects, WithoutColorsByShape) {
  ModelLibrary library;
  library.objects = {make_plate({200, 30, 30}), make_plate({30, 30, 200}), make_plate({190, 40, 30})};
  for (const std::size_t i : {0, 1}) library.objects[i].surface.colors.clear();
  library.objects.emplace_back();  // Without surface.
  EXPECT_THAT(find_equal_objects(library), testing::ElementsAre(testing::Pair(0, 1)));
}

}  // namespace
}  // namespace resight
