// SPDX-License-Identifier: Apache-2.0
#include "resight/modelling/build_model.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>

#include "resight/io/mesh.hpp"
#include "resight/io/model_source.hpp"
#include "resight/modelling/write_model.hpp"
#include "resight/rendering/turntable.hpp"
#include "resight/simulation/procedural_objects.hpp"
#include "resight/training/train_library.hpp"

namespace resight {
namespace {

namespace fs = std::filesystem;

fs::path temporary_folder(const std::string& name) {
  return fs::path(testing::TempDir()) / fmt::format("resight_{}_{}", name, ::getpid());
}

std::vector<TrainingView> scan(const char* name, bool both_sides) {
  TurntableOptions turntable;
  turntable.step_deg = 30;
  turntable.both_sides = both_sides;
  turntable.sensor_noise = true;
  turntable.num_threads = 2;
  return render_turntable(make_procedural_object(name)->mesh, turntable);
}

BuildModelOptions two_threads() {
  BuildModelOptions options;
  options.num_threads = 2;
  return options;
}

// A can from both sides and the model of it, made once for all tests.
struct PeaCan {
  std::vector<TrainingView> views = scan("soup_pea", true);
  Result<ObjectModelBuild> build = build_model(views, two_threads());
};

const PeaCan& pea_can() {
  static const PeaCan instance;
  return instance;
}

TEST(BuildModel, WritesAFolderThatCanBeTrainedFrom) {
  const auto& [views, build] = pea_can();
  ASSERT_TRUE(build.ok()) << build.error().message;
  EXPECT_EQ(build->report.num_views, 24);
  EXPECT_EQ(build->key_views.size(), 24U);
  EXPECT_GT(build->report.keypoints_per_view, 40);
  EXPECT_NEAR(build->report.diameter_m, diameter(make_procedural_object("soup_pea")->mesh.vertices), 0.004);
  EXPECT_LT(build->report.holes.open_share, 0.05);
  EXPECT_TRUE(build->report.symmetries.none());
  EXPECT_TRUE(build->report.troubles.empty()) << build->report.troubles[0];

  const fs::path folder = temporary_folder("build_model") / "pea";
  fs::remove_all(folder.parent_path());
  ASSERT_TRUE(write_object_model(folder, views, *build).ok());
  EXPECT_FALSE(write_object_model(folder, views, *build).ok());
  EXPECT_FALSE(fs::exists(folder / "model_info.json"));
  EXPECT_EQ(read_mesh(folder / "mesh.ply")->mesh.faces.size(), build->mesh.faces.size());
  EXPECT_TRUE(fs::exists(folder / "model_report.json"));
  for (const fs::path& path : {folder, folder.parent_path()}) {
    const auto locations = find_models({path});
    ASSERT_TRUE(locations.ok()) << locations.error().message;
    ASSERT_EQ(locations->size(), 1U);
    EXPECT_EQ((*locations)[0].name, "pea");
    EXPECT_EQ((*locations)[0].format, "tuw");
  }
  const auto source = read_model((*find_models({folder}))[0]);
  ASSERT_TRUE(source.ok()) << source.error().message;
  ASSERT_EQ(source->views.size(), 24U);
  EXPECT_EQ(source->views[7].mask, views[7].mask);
  EXPECT_EQ(source->surface->size(), build->cloud.size());
  TrainOptions train;
  train.num_threads = 2;
  const auto library = train_library(*find_models({folder}), train);
  ASSERT_TRUE(library.ok()) << library.error().message;
  EXPECT_GT(library->objects[0].sift.size(), 300U);
  fs::remove_all(folder.parent_path());
}

TEST(BuildModel, WritesWhatIsDeclaredOfTheObject) {
  const auto& [views, build] = pea_can();
  ASSERT_TRUE(build.ok()) << build.error().message;
  DeclaredModelInfo declared;
  declared.bop_id = 7;
  declared.symmetries.continuous.push_back({});
  const fs::path folder = temporary_folder("declared_model") / "pea";
  fs::remove_all(folder.parent_path());
  ASSERT_TRUE(write_object_model(folder, views, *build, declared).ok());
  const auto model = read_model(find_models({folder})->at(0));
  ASSERT_TRUE(model.ok()) << model.error().message;
  EXPECT_EQ(model->bop_id, 7);
  EXPECT_EQ(model->symmetries.continuous.size(), 1U);
  EXPECT_TRUE(model->symmetries_known);
  for (const bool known : {true, false}) {
    fs::remove_all(folder);
    ASSERT_TRUE(write_object_model(folder, views, *build, {.symmetries = {}, .symmetries_known = known}).ok());
    const auto plain = read_model(find_models({folder})->at(0));
    ASSERT_TRUE(plain.ok()) << plain.error().message;
    EXPECT_TRUE(plain->symmetries.none());
    EXPECT_EQ(plain->symmetries_known, known);
  }
  fs::remove_all(folder.parent_path());
}

TEST(BuildModel, WarnsOfWhatWillBeHard) {
  // An untextured can from one side: no texture, an open bottom, symmetric.
  const auto build = build_model(scan("plain_can", false), two_threads());
  ASSERT_TRUE(build.ok()) << build.error().message;
  EXPECT_LT(build->report.keypoints_per_view, 20);
  EXPECT_EQ(build->report.symmetries.continuous.size(), 1U);
  EXPECT_GT(build->report.holes.open_share, 0.05);
  EXPECT_GE(build->report.holes.count, 1);
  EXPECT_EQ(build->report.coverage.share_below, 0);
  const std::string text = format_report(build->report);
  for (const char* word : {"few features", "holes: ", "observed from ", "symmetric"})
    EXPECT_THAT(text, testing::HasSubstr(word));
}

TEST(BuildModel, ViewsWithoutTheObjectAreAnError) {
  std::vector<TrainingView> views = pea_can().views;
  for (TrainingView& view : views) std::ranges::fill(view.mask.data(), std::uint8_t{0});
  EXPECT_FALSE(build_model(views).ok());
  EXPECT_FALSE(build_model({}).ok());
  BuildModelOptions options;
  options.cloud_spacing_m = 0;
  EXPECT_THROW(options.check(), std::invalid_argument);
}

}  // namespace
}  // namespace resight
