// SPDX-License-Identifier: Apache-2.0
#include "resight/simulation/tabletop_library.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>

#include "resight/io/model_source.hpp"
#include "resight/simulation/seeded_objects.hpp"

namespace resight {
namespace {

namespace fs = std::filesystem;

TEST(TabletopLibrary, IsHalfRecordedAndAQuarterScanned) {
  const std::vector<TabletopModel> models = tabletop_models(1);
  const auto count = [&](ModelOrigin origin) { return std::ranges::count(models, origin, &TabletopModel::origin); };
  ASSERT_EQ(models.size(), seeded_object_names(1).known.size());
  EXPECT_EQ(count(ModelOrigin::kRecording), 14);
  EXPECT_EQ(count(ModelOrigin::kMesh), 7);
  EXPECT_EQ(count(ModelOrigin::kScan), 7);
  EXPECT_TRUE(std::ranges::is_sorted(models, {}, &TabletopModel::name));
  for (std::size_t i = 0; i < models.size(); ++i) {
    EXPECT_EQ(models[i].bop_id, static_cast<int>(i) + 1);
    if (models[i].origin != ModelOrigin::kRecording) continue;
    const auto object = make_seeded_object(1, models[i].name);
    ASSERT_TRUE(object.ok());
    EXPECT_NE(object->kind, "plain") << models[i].name;
    EXPECT_GT(object->material.depth_return, 0.5) << models[i].name;
  }
}

TEST(TabletopLibrary, MeshesKeepTheirNumbersAndScansCarryLight) {
  const fs::path folder = fs::temp_directory_path() / ("resight_library_" + std::to_string(::getpid()));
  fs::remove_all(folder);
  const auto written = write_tabletop_meshes(1, folder);
  ASSERT_TRUE(written.ok()) << written.error().message;
  const auto found = find_models({folder / "models"});
  ASSERT_TRUE(found.ok()) << found.error().message;
  const std::vector<TabletopModel> models = tabletop_models(1);
  EXPECT_EQ(found->size(), 14U);
  int compared = 0;
  for (const ModelLocation& location : *found) {
    const auto model = std::ranges::find(models, location.name, &TabletopModel::name);
    ASSERT_NE(model, models.end()) << location.name;
    EXPECT_EQ(location.bop_id, model->bop_id);
    const auto source = read_model(location);
    const auto object = make_seeded_object(1, location.name);
    ASSERT_TRUE(source.ok() && object.ok());
    if (!object->mesh.has_texture()) continue;
    ++compared;
    EXPECT_EQ(source->mesh->texture == object->mesh.texture, model->origin == ModelOrigin::kMesh) << location.name;
  }
  EXPECT_GE(compared, 4);
  fs::remove_all(folder);
}

}  // namespace
}  // namespace resight
