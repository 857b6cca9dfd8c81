// SPDX-License-Identifier: Apache-2.0
#include "resight/report/scene_changes.hpp"

#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

namespace resight {
namespace {

using ::testing::ElementsAre;

ChangeRegion region_of(std::vector<int> pixels) {
  ChangeRegion region;
  region.kind = RegionKind::kRemoved;
  region.pixels = std::move(pixels);
  return region;
}

TEST(FormatSceneChanges, PixelsAreThoseOfTheRecordedImage) {
  const auto format = [](int reduction) {
    ViewChangeRecord view;
    view.view_name = "a";
    view.image_width_px = 10;
    view.reduction = reduction;
    view.regions = {region_of({12, 13, 23}), region_of({})};
    return nlohmann::json::parse(format_scene_changes_json({"1", "default", "s", {view}}))["views"][0]["regions"];
  };
  const nlohmann::json whole = format(1);
  EXPECT_THAT(whole.at(0)["rectangle_px"].get<std::vector<int>>(), ElementsAre(2, 1, 2, 2));
  EXPECT_EQ(whole[0]["pixels"], 3);
  EXPECT_EQ(whole[0]["kind"], "removed");
  EXPECT_TRUE(whole.at(1)["rectangle_px"].is_null());
  const nlohmann::json reduced = format(3);
  EXPECT_THAT(reduced.at(0)["rectangle_px"].get<std::vector<int>>(), ElementsAre(6, 3, 6, 6));
  EXPECT_EQ(reduced[0]["pixels"], 27);
}

}  // namespace
}  // namespace resight
