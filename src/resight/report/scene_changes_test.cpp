// SPDX-License-Identifier: Apache-2.0
#include "resight/report/scene_changes.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

namespace resight {
namespace {

TEST(SceneChangesJson, NumbersRegionsAcrossViews) {
  const ChangeRegion came{RegionKind::kNovel, {{{0, 0, 1}}, {}, {}}, {12, 15, 23, 31}, {{}, {0.3, 0.2, 0.1}}};
  const ChangeRegion left{RegionKind::kRemoved, {{{0, 0, 1}, {0, 0, 2}}, {}, {}}, {}, {}};
  const SceneChanges changes{
      "1.0", "default", "desk", {{"first", 10, 1, {}, 0, false, {}}, {"second", 10, 1, {}, 0.25, true, {came, left}}}};
  const auto parsed = nlohmann::json::parse(format_scene_changes_json(changes));
  EXPECT_EQ(parsed["preset"], "default");
  ASSERT_EQ(parsed["views"].size(), 2U);
  EXPECT_TRUE(parsed["views"][0]["regions"].empty());
  const auto& second = parsed["views"][1];
  EXPECT_EQ(second["view"], 1);
  EXPECT_EQ(second["changed_share"], 0.25);
  EXPECT_EQ(second["pose_suspect"], true);
  ASSERT_EQ(second["regions"].size(), 2U);
  EXPECT_EQ(second["regions"][0]["id"], 1);
  EXPECT_EQ(second["regions"][0]["kind"], "novel");
  EXPECT_EQ(second["regions"][0]["rectangle_px"], nlohmann::json({1, 1, 5, 3}));
  EXPECT_EQ(second["regions"][0]["box_size_m"], nlohmann::json({0.3, 0.2, 0.1}));
  EXPECT_EQ(second["regions"][1]["id"], 2);
  EXPECT_EQ(second["regions"][1]["kind"], "removed");
  EXPECT_EQ(second["regions"][1]["points"], 2);
  EXPECT_TRUE(second["regions"][1]["rectangle_px"].is_null());
}

TEST(SceneChangesJson, PixelsAreThoseOfTheRecordedImage) {
  const ChangeRegion came{RegionKind::kNovel, {{{0, 0, 1}}, {}, {}}, {12, 15, 23, 31}, {}};
  const auto region = [&](int reduction) {
    const SceneChanges changes{"1.0", "default", "desk", {{"first", 10, reduction, {}, 0, false, {came}}}};
    return nlohmann::json::parse(format_scene_changes_json(changes))["views"][0]["regions"][0];
  };
  EXPECT_EQ(region(1)["pixels"], 4);
  EXPECT_EQ(region(3)["pixels"], 36);
  EXPECT_EQ(region(3)["rectangle_px"], nlohmann::json({3, 3, 15, 9}));
}

}  // namespace
}  // namespace resight
