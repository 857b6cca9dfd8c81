// SPDX-License-Identifier: Apache-2.0
#include "resight/simulation/scene_script.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <numbers>

#include "resight/simulation/presets.hpp"

namespace resight {
namespace {

namespace fs = std::filesystem;

constexpr const char* kGood = R"(
name = "small"
[camera]
width = 320
height = 240
[camera.orbit]
radius_m = 1.5
start_deg = -90
end_deg = 0
views = 4
[[furniture]]
kind = "table"
[[object]]
model = "mug"
on = "table"
x_m = 0.1
yaw_deg = 90
[[object]]
model = "vase"
present = false
[[change]]
view = 2
kind = "add"
object = "vase"
on = "table"
)";

class SceneFile : public testing::Test {
 protected:
  void SetUp() override {
    const auto* test = testing::UnitTest::GetInstance()->current_test_info();
    path_ = fs::temp_directory_path() /
            (std::string("resight_scene_") + test->name() + std::to_string(::getpid()) + ".toml");
  }
  void TearDown() override { fs::remove(path_); }
  Result<SceneScript> read(const std::string& text) {
    std::ofstream(path_) << text;
    return read_scene_script(path_);
  }
  fs::path path_;
};

std::string replaced(std::string text, const std::string& what, const std::string& by) {
  const auto at = text.find(what);
  EXPECT_NE(at, std::string::npos) << what;
  return text.replace(at, what.size(), by);
}

TEST_F(SceneFile, ReadsWhatIsWritten) {
  const auto script = read(kGood);
  ASSERT_TRUE(script.ok()) << script.error().message;
  EXPECT_EQ(script->name, "small");
  EXPECT_EQ(script->camera.width, 320);
  EXPECT_DOUBLE_EQ(script->camera.cx, 159.5);
  ASSERT_EQ(script->world_from_camera.size(), 4U);
  EXPECT_LT((script->world_from_camera.front().translation - Eigen::Vector3d(0, -1.5, 1.4)).norm(), 1e-9);
  EXPECT_LT((script->world_from_camera.back().translation - Eigen::Vector3d(1.5, 0, 1.4)).norm(), 1e-9);
  ASSERT_EQ(script->objects.size(), 2U);
  EXPECT_EQ(script->objects[0].key, "mug");
  EXPECT_NEAR(script->objects[0].start->yaw_rad, std::numbers::pi / 2, 1e-12);
  EXPECT_FALSE(script->objects[1].start.has_value());
  ASSERT_EQ(script->changes.size(), 1U);
  EXPECT_EQ(script->changes[0].kind, ChangeKind::kAdded);
}

TEST_F(SceneFile, ReadsDevicesAndLight) {
  const std::string text = replaced(kGood, "[[object]]", R"([[light.lamp]]
position_m = [1, 1, 2]
intensity = [0.6, 0.5, 0.4]
radius_m = 0.1
[camera.drift]
position_sigma_m = 0.005
seed = 3
[camera.lens]
k1 = 0.004
[sensor.depth_errors]
shift_u_px = 1.5
[sensor.depth_errors.lens]
k1 = 0.01
[sensor.color_camera]
mosaic = true
jpeg_quality = 80
[[object]])");
  const auto script = read(text);
  ASSERT_TRUE(script.ok()) << script.error().message;
  ASSERT_EQ(script->lighting.lamps.size(), 1U);
  EXPECT_EQ(script->lighting.lamps[0].intensity, Eigen::Vector3d(0.6, 0.5, 0.4));
  ASSERT_EQ(script->reported_world_from_camera.size(), 4U);
  EXPECT_NE(reported_pose(*script, 3).translation, script->world_from_camera[3].translation);
  EXPECT_DOUBLE_EQ(script->color_lens.k1, 0.004);
  ASSERT_TRUE(script->sensor.depth_errors && script->sensor.color_camera);
  EXPECT_DOUBLE_EQ(script->sensor.depth_errors->shift_u_px, 1.5);
  EXPECT_DOUBLE_EQ(script->sensor.depth_errors->lens.k1, 0.01);
  EXPECT_EQ(script->sensor.color_camera->jpeg_quality, 80);
  for (const auto& [what, by] : {std::pair{"jpeg_quality = 80", "jpeg_quality = 0"},
                                 {"shift_u_px = 1.5", "shift_w_px = 1.5"},
                                 {"position_sigma_m = 0.005", "position_sigma_m = -1"},
                                 {"k1 = 0.004", "k1 = 7"},
                                 {"seed = 3", "seed = -3"}})
    EXPECT_FALSE(read(replaced(text, what, by)).ok()) << by;
}

TEST_F(SceneFile, SeedsAreLarge) {
  for (const std::uint64_t seed : {3000000000ULL, 9223372036854775807ULL}) {
    const std::string drift = "[camera.drift]\nposition_sigma_m = 0.01\nseed = " + std::to_string(seed);
    const auto script =
        read("object_seed = " + std::to_string(seed) + replaced(kGood, "[camera.orbit]", drift + "\n[camera.orbit]"));
    ASSERT_TRUE(script.ok()) << script.error().message;
    EXPECT_EQ(script->object_seed, seed);
  }
}

TEST_F(SceneFile, ErrorsNameFileKeyAndRule) {
  struct Case {
    const char* what;
    const char* by;
    std::vector<const char*> message;
  };
  const std::vector<Case> cases{
      {"x_m = 0.1", "x_m = \"left\"", {"object[0].x_m", "number"}},
      {"x_m = 0.1", "x_m = nan", {"object[0].x_m", "finite"}},
      {"x_m = 0.1", "x_mm = 0.1", {"object[0].x_mm", "not a known key"}},
      {"model = \"mug\"", "model = \"mugg\"", {"object[0].model", "mugg"}},
      {"model = \"mug\"", "key = \"m\"", {"object[0].model", "missing"}},
      {"on = \"table\"\nx_m", "on = \"chair\"\nx_m", {"object[0].on", "chair"}},
      {"on = \"table\"\nx_m", "on = \"mug\"\nx_m", {"object[0].on", "itself"}},
      {"on = \"table\"\nx_m", "on = 3\nx_m", {"object[0].on", "quotes"}},
      {"yaw_deg = 90", "pose = [1, 0, 0]", {"object[0].pose", "16 numbers"}},
      {"yaw_deg = 90", "pose = [2,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1]", {"object[0].pose", "rigid"}},
      {"yaw_deg = 90", "pose = [1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1]", {"object[0].pose", "excludes on"}},
      {"present = false", "present = 0", {"object[1].present", "true or false"}},
      {"present = false", "present = false\nx_m = 1", {"object[1].x_m", "not present"}},
      {"present = false", "on = \"table\"", {"change[0]", "it is there"}},
      {"kind = \"table\"", "kind = \"throne\"", {"furniture[0].kind", "throne"}},
      {"kind = \"table\"", "kind = \"table\"\nsize_m = [1, 2]", {"furniture[0].size_m", "3 numbers"}},
      {"kind = \"table\"", "kind = \"table\"\nsize_m = [1, 2, -1]", {"furniture[0].size_m", "> 0"}},
      {"kind = \"add\"", "kind = \"explode\"", {"change[0].kind", "add"}},
      {"kind = \"add\"", "kind = \"move\"", {"change[0]", "it is not there"}},
      {"view = 2", "view = 4", {"change[0].view", "1..3"}},
      {"view = 2", "view = 0", {"change[0].view", "1..3"}},
      {"view = 2", "view = 1.5", {"change[0].view", "whole number"}},
      {"object = \"vase\"", "object = \"mouse\"", {"change[0].object", "mouse"}},
      {"views = 4", "views = 0", {"camera.orbit.views", "1..100000"}},
      {"radius_m = 1.5", "radius_m = 0", {"camera.orbit.radius_m", "> 0"}},
      {"radius_m = 1.5", "radius_m = 1e-9", {"camera.orbit.radius_m", "straight up or down"}},
      {"[camera.orbit]\nradius_m = 1.5\nstart_deg = -90\nend_deg = 0\nviews = 4",
       "[[camera.pose]]\neye_m = [0, -1, 1e61]\ntarget_m = [0, 0, 1]",
       {"camera.pose[0].eye_m", "between"}},
      {"[camera.orbit]\nradius_m = 1.5\nstart_deg = -90\nend_deg = 0\nviews = 4",
       "[[camera.pose]]\neye_m = [0, 0, 5]\ntarget_m = [0, 0, 1]",
       {"camera.pose[0].target_m", "straight above or below"}},
      {"x_m = 0.1", "x_m = 1e308", {"object[0].x_m", "between"}},
      {"width = 320", "width = 2147483647", {"camera", "too many"}},
      {"width = 320", "width = 16385", {"camera", "16385 x 240", "16384 a side"}},
      {"width = 320\nheight = 240", "width = 16384\nheight = 16384", {"camera", "too many", "16777216"}},
      {"width = 320", "width = 320\nfx = 1e-300", {"camera", "hundredth"}},
      {"kind = \"table\"", "kind = \"table\"\nsize_m = [1, 2, 1e308]", {"furniture[0].size_m", "between"}},
      {"kind = \"table\"", "kind = \"table\"\nsize_m = [1, 2, 10.1]", {"furniture[0].size_m", "0.001..10"}},
      {"name = \"small\"", "name = \"small\"\n[room]\nsize_m = [5, 50.1, 3]", {"room.size_m", "0.5..50"}},
      {"name = \"small\"", "name = \"small\"\n[room]\nsize_m = [0.49, 5, 3]", {"room.size_m", "0.5..50"}},
      {"model = \"vase\"", "key = \"a/b\"\nmodel = \"vase\"", {"object[1].key"}},
      {"width = 320", "width = -2147483648", {"camera", "positive"}},
      {"width = 320", "width = -3", {"camera", "positive"}},
      {"[camera.orbit]", "[camera.orbits]", {"camera.orbits", "not a known key"}},
      {"name = \"small\"", "name = \"a/b\"", {"name", "folder"}},
      {"name = \"small\"", "name = \"small\"\n[sensor]\nedge_dropout = 2", {"edge_dropout", "2"}},
      {"name = \"small\"", "name = small", {"line 2"}},
      {"name = \"small\"", "object_seed = -3", {"object_seed", "whole number >= 0"}},
      {"name = \"small\"", "object_seed = 1.5", {"object_seed", "whole number >= 0"}},
  };
  for (const Case& c : cases) {
    const auto script = read(replaced(kGood, c.what, c.by));
    ASSERT_FALSE(script.ok()) << c.what << " -> " << c.by;
    EXPECT_EQ(script.error().message.find(path_.string()), 0U) << script.error().message;
    for (const char* part : c.message)
      EXPECT_NE(script.error().message.find(part), std::string::npos) << script.error().message;
    EXPECT_EQ(script.error().message.find('\n'), std::string::npos) << script.error().message;
  }
}

TEST_F(SceneFile, LongNamesAreRefused) {
  const std::string name(300, 'n');
  for (const auto& [what, by] : {std::pair{"name = \"small\"", "name = \"" + name + "\""},
                                 {"model = \"mug\"", "model = \"" + name + "\"\nmesh = \"mug.ply\""},
                                 {"kind = \"table\"", "kind = \"table\"\nkey = \"" + name + "\""}}) {
    const auto script = read(replaced(kGood, what, by));
    ASSERT_FALSE(script.ok()) << what;
    EXPECT_NE(script.error().message.find("200"), std::string::npos) << script.error().message;
  }
}

TEST_F(SceneFile, MissingFileIsAnError) {
  const auto script = read_scene_script("/nowhere/scene.toml");
  ASSERT_FALSE(script.ok());
  EXPECT_NE(script.error().message.find("/nowhere/scene.toml"), std::string::npos);
}

TEST(SceneScript, RefusesFloatingThings) {
  SceneScript script = make_demo_scene(1);
  script.objects.push_back(
      {"on_top", "sponge", {}, true, Placement{.support = "brick", .world_from_object = std::nullopt}});
  EXPECT_TRUE(check_script(script).ok());
  script.changes.push_back({11, ChangeKind::kRemoved, "brick", {}});
  const auto checked = check_script(script);
  ASSERT_FALSE(checked.ok());
  EXPECT_NE(checked.error().message.find("float"), std::string::npos);
}

TEST(SceneScript, ExamplesAreGood) {
  int count = 0;
  for (const auto& entry : fs::directory_iterator(fs::path(RESIGHT_SOURCE_DIR) / "examples" / "scenes")) {
    if (entry.path().extension() != ".toml") continue;
    const auto script = read_scene_script(entry.path());
    EXPECT_TRUE(script.ok()) << script.error().message;
    ++count;
  }
  EXPECT_GE(count, 2);
}

}  // namespace
}  // namespace resight
