// SPDX-License-Identifier: Apache-2.0
#include "resight/simulation/write_simulation.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

#include "resight/io/model_source.hpp"
#include "resight/io/ply.hpp"

namespace resight {
namespace {

namespace fs = std::filesystem;

SceneScript small_scene() {
  SceneScript script;
  script.name = "tiny";
  script.room_size_m.reset();
  script.camera = {160, 120, 131.25, 131.25, 79.5, 59.5};
  script.furniture.push_back({"table", "table", {1.0, 0.7, 0.7}, {}});
  const auto on_table = [](double x, double y) {
    Placement p;
    p.support = "table";
    p.x_m = x;
    p.y_m = y;
    return p;
  };
  script.objects = {{"can_a", "plain_can", {}, true, on_table(-0.2, 0)},
                    {"can_b", "plain_can", {}, true, on_table(0.1, 0)},
                    {"mug", "mug", {}, true, on_table(0.25, 0.1)},
                    {"vase", "vase", {}, true, on_table(0, 0.2)}};
  script.changes = {{1, ChangeKind::kRemoved, "can_a", {}}, {2, ChangeKind::kMoved, "mug", on_table(-0.2, 0.1)}};
  OrbitScript orbit;
  orbit.num_views = 4;
  orbit.center_m.z() = 0.75;
  script.world_from_camera = make_orbit(orbit);
  return script;
}

class WriteSimulation : public testing::TestWithParam<DatasetFormat> {
 protected:
  void SetUp() override {
    directory_ = fs::temp_directory_path() /
                 ("resight_write_" + std::to_string(::getpid()) + (GetParam() == DatasetFormat::kTuw ? "t" : "b"));
    fs::remove_all(directory_);
    options_.turntable.step_deg = 180;
    options_.turntable.both_sides = false;
  }
  void TearDown() override { fs::remove_all(directory_); }
  fs::path directory_;
  WriteSimulationOptions options_;
};

TEST_P(WriteSimulation, CanBeReadBack) {
  auto simulation = Simulation::create(small_scene(), 5);
  ASSERT_TRUE(simulation.ok()) << simulation.error().message;
  int steps = 0;
  options_.progress = [&](const std::string&) { ++steps; };
  const auto written = write_simulation(*simulation, directory_, GetParam(), options_);
  ASSERT_TRUE(written.ok()) << written.error().message;
  EXPECT_EQ(steps, 2 + 4);

  const bool is_tuw = GetParam() == DatasetFormat::kTuw;
  const auto sequence = open_sequence(directory_ / "test" / (is_tuw ? "tiny" : "000001"));
  ASSERT_TRUE(sequence.ok()) << sequence.error().message;
  ASSERT_EQ((*sequence)->num_views(), 4);
  std::size_t compared = 0;
  for (int i = 0; i < 4; ++i) {
    const SimulatedView expected = simulation->render_view(i);
    const auto frame = (*sequence)->read_view(i);
    ASSERT_TRUE(frame.ok()) << frame.error().message;
    EXPECT_LT((frame->world_from_camera.translation - expected.frame.world_from_camera.translation).norm(), 1e-5);
    EXPECT_LT(rotation_angle_rad(frame->world_from_camera.rotation, expected.frame.world_from_camera.rotation), 1e-5);
    EXPECT_EQ(count_valid(frame->depth_m), count_valid(expected.frame.depth_m));
    EXPECT_EQ(frame->color, expected.frame.color);
    for (std::size_t k = 0; k < frame->depth_m.size(); ++k) {
      ASSERT_EQ(std::isnan(frame->depth_m[k]), std::isnan(expected.frame.depth_m[k]));
      if (std::isnan(frame->depth_m[k])) continue;
      ASSERT_NEAR(frame->depth_m[k], expected.frame.depth_m[k], 6e-4);  // BOP rounds to 0.1 mm
    }
    const auto truth = (*sequence)->read_ground_truth(i);
    ASSERT_TRUE(truth.ok()) << truth.error().message;
    ASSERT_EQ(truth->size(), expected.ground_truth.size());
    for (const GroundTruthObject& g : *truth)
      for (const GroundTruthObject& e : expected.ground_truth)
        if ((is_tuw ? e.object == g.object : e.bop_id == g.bop_id) && e.instance == g.instance) {
          EXPECT_LT((e.camera_from_object.translation - g.camera_from_object.translation).norm(), 1e-5);
          EXPECT_NEAR(e.visible_share, g.visible_share, 0.01);
          ++compared;
        }
  }
  EXPECT_GE(compared, 9U);

  const auto models = find_models({directory_ / "models"});
  ASSERT_TRUE(models.ok()) << models.error().message;
  ASSERT_EQ(models->size(), 2U);
  for (const ModelLocation& location : *models) {
    const auto model = read_model(location);
    ASSERT_TRUE(model.ok()) << model.error().message;
    EXPECT_EQ(model->views.size(), is_tuw ? 2U : 0U);
    EXPECT_EQ(model->mesh.has_value(), !is_tuw);
    EXPECT_EQ(model->symmetries.none(), model->name == "mug") << model->name;
  }
}

TEST_P(WriteSimulation, ChainsAndEventsTellTheChanges) {
  auto simulation = Simulation::create(small_scene(), 5);
  ASSERT_TRUE(simulation.ok());
  options_.models = false;
  ASSERT_TRUE(write_simulation(*simulation, directory_, GetParam(), options_).ok());
  const std::string scene = GetParam() == DatasetFormat::kTuw ? "tiny" : "000001";
  const auto chains = read_changes(directory_ / "test" / (scene + ".changes"));
  ASSERT_TRUE(chains.ok()) << chains.error().message;
  // Chains: the mug before and after its move, one can through all views, one can in the first view only.
  ASSERT_EQ(chains->size(), 4U);
  std::vector<std::size_t> lengths;
  for (const ChangeChain& c : *chains) lengths.push_back(c.entries.size());
  EXPECT_EQ(lengths, (std::vector<std::size_t>{2, 2, 1, 4}));
  // The remaining can is number 1 beside the other one, and number 0 when it is alone.
  EXPECT_EQ((*chains)[3].entries[0].instance, 1);
  EXPECT_EQ((*chains)[3].entries[1].instance, 0);

  std::ifstream file(directory_ / "events.json");
  const nlohmann::json json = nlohmann::json::parse(file);
  ASSERT_EQ(json["events"].size(), 2U);
  EXPECT_EQ(json["events"][0]["kind"], "removed");
  EXPECT_EQ(json["events"][0]["instance"], "can_a");
  EXPECT_TRUE(json["events"][0]["world_from_object_after"].is_null());
  EXPECT_NEAR(json["events"][1]["world_from_object_after"][3].get<double>(), -0.2, 1e-12);
  EXPECT_NEAR(json["events"][1]["world_from_object_after"][11].get<double>(), 0.7, 1e-6);
}

// Evaluations of their changes need them.
TEST_P(WriteSimulation, ModelsOfUnknownObjectsAreWritten) {
  const fs::path mesh = directory_.string() + ".ply";
  ASSERT_TRUE(write_ply(mesh, make_procedural_object("brick")->mesh).ok());
  SceneScript script = small_scene();
  script.objects.push_back({"tea_box", "tea_box", {}, false, script.objects[1].start});
  script.objects.push_back({"stone", "stone", mesh, false, script.objects[2].start});
  auto simulation = Simulation::create(script, 5);
  fs::remove(mesh);
  ASSERT_TRUE(simulation.ok()) << simulation.error().message;
  ASSERT_TRUE(write_simulation(*simulation, directory_, GetParam(), options_).ok());
  const auto unknown = find_models({directory_ / "unknown" / "models"});
  ASSERT_TRUE(unknown.ok()) << unknown.error().message;
  std::vector<std::string> names;
  for (const ModelLocation& location : *unknown) {
    const auto model = read_model(location);
    ASSERT_TRUE(model.ok()) << model.error().message;
    EXPECT_TRUE(model->mesh) << location.name;
    names.push_back(location.name);
  }
  EXPECT_EQ(names, (std::vector<std::string>{"stone", "tea_box", "vase"}));
  // They are not among the models of the data set.
  const auto known = find_models({directory_});
  ASSERT_TRUE(known.ok()) << known.error().message;
  EXPECT_EQ(known->size(), 2U);
}

TEST_P(WriteSimulation, NoUnknownObjectIsNoError) {
  SceneScript script = small_scene();
  script.objects.pop_back();
  auto simulation = Simulation::create(script, 5);
  ASSERT_TRUE(simulation.ok()) << simulation.error().message;
  ASSERT_TRUE(write_simulation(*simulation, directory_, GetParam(), options_).ok());
  EXPECT_FALSE(fs::exists(directory_ / "unknown"));
}

TEST_P(WriteSimulation, NoKnownObjectIsNoError) {
  SceneScript script = small_scene();
  std::erase_if(script.objects, [](const ObjectScript& object) { return object.model != "vase"; });
  script.changes.clear();
  auto simulation = Simulation::create(script, 5);
  ASSERT_TRUE(simulation.ok()) << simulation.error().message;
  const auto written = write_simulation(*simulation, directory_, GetParam(), options_);
  ASSERT_TRUE(written.ok()) << written.error().message;
  EXPECT_FALSE(fs::exists(directory_ / "models"));
  const auto sequence = open_sequence(directory_ / "test" / (GetParam() == DatasetFormat::kTuw ? "tiny" : "000001"));
  ASSERT_TRUE(sequence.ok()) << sequence.error().message;
  EXPECT_EQ((*sequence)->num_views(), 4);
}

TEST_P(WriteSimulation, NeverWritesOverData) {
  fs::create_directories(directory_);
  std::ofstream(directory_ / "precious.txt") << "mine";
  auto simulation = Simulation::create(small_scene(), 5);
  ASSERT_TRUE(simulation.ok());
  const auto written = write_simulation(*simulation, directory_, GetParam(), options_);
  ASSERT_FALSE(written.ok());
  EXPECT_NE(written.error().message.find(directory_.string()), std::string::npos);
  EXPECT_TRUE(fs::exists(directory_ / "precious.txt"));
  EXPECT_EQ(std::distance(fs::directory_iterator(directory_), {}), 1) << "must leave nothing else";
}

INSTANTIATE_TEST_SUITE_P(Formats, WriteSimulation, testing::Values(DatasetFormat::kTuw, DatasetFormat::kBop),
                         [](const auto& tested) { return tested.param == DatasetFormat::kTuw ? "Tuw" : "Bop"; });

}  // namespace
}  // namespace resight
