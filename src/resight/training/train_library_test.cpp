// SPDX-License-Identifier: Apache-2.0
#include "resight/training/train_library.hpp"

#include <gmock/gmock.h>
#include <unistd.h>

#include <filesystem>

#include "resight/io/ply.hpp"
#include "resight/models/library_file.hpp"
#include "resight/simulation/procedural_objects.hpp"

namespace resight {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

TrainOptions quick_library_options() {
  TrainOptions options;
  options.turntable.step_deg = 120;
  options.turntable.both_sides = false;
  return options;
}

ProceduralObject make_any_object(std::size_t index = 0) {
  return *make_procedural_object(procedural_object_names().at(index));
}

class MeshFolder : public testing::Test {
 protected:
  MeshFolder() : folder_(fs::temp_directory_path() / ("resight_train_test_" + std::to_string(getpid()))) {
    fs::create_directories(folder_);
    for (std::size_t i = 0; i < 2; ++i)
      written_ =
          written_ && write_ply(folder_ / (procedural_object_names().at(i) + ".ply"), make_any_object(i).mesh).ok();
  }
  ~MeshFolder() override { fs::remove_all(folder_); }
  MeshFolder(const MeshFolder&) = delete;
  MeshFolder& operator=(const MeshFolder&) = delete;
  fs::path folder_;
  bool written_ = true;
};

TEST_F(MeshFolder, IsTrainedIntoALibraryThatAFileGivesBack) {
  ASSERT_TRUE(written_);
  const Result<std::vector<ModelLocation>> locations = find_models({folder_});
  ASSERT_TRUE(locations.ok()) << locations.error().message;
  ASSERT_EQ(locations->size(), 2U);
  std::vector<std::string> progress;
  const TrainOptions options = quick_library_options();
  const Result<ModelLibrary> library =
      train_library(*locations, options, [&](int index, int count, const std::string& name) {
        progress.push_back(std::to_string(index) + "/" + std::to_string(count) + " " + name);
      });
  ASSERT_TRUE(library.ok()) << library.error().message;
  ASSERT_EQ(library->objects.size(), 2U);
  EXPECT_EQ(progress, (std::vector{"0/2 " + library->objects[0].name, "1/2 " + library->objects[1].name}));
  EXPECT_EQ(library->options_hash, options.hash());
  EXPECT_EQ(library->surface_voxel_m, 0.003F);
  EXPECT_EQ(library->objects[0].bop_id, 1);
  EXPECT_EQ(library->objects[1].bop_id, 2);
  EXPECT_EQ(library->find(procedural_object_names()[1]) >= 0, true);

  const fs::path file = folder_ / "models.bin";
  ASSERT_TRUE(save_library(*library, file).ok());
  const Result<ModelLibrary> loaded = load_library(file, options.hash());
  ASSERT_TRUE(loaded.ok()) << loaded.error().message;
  for (std::size_t i = 0; i < 2; ++i) {  // memory equals file, including descriptors
    EXPECT_EQ(loaded->objects[i].sift.codes, library->objects[i].sift.codes);
    EXPECT_EQ(loaded->objects[i].shot.codes, library->objects[i].shot.codes);
    EXPECT_EQ(loaded->objects[i].surface.points, library->objects[i].surface.points);
  }
  TrainOptions other = options;
  other.surface_voxel_m = 0.004;
  EXPECT_FALSE(load_library(file, other.hash()).ok());
}

TEST_F(MeshFolder, AnUnreadableModelNamesItsFile) {
  const Result<std::vector<ModelLocation>> locations = find_models({folder_});
  ASSERT_TRUE(locations.ok());
  fs::resize_file(locations->front().path, 20);
  const Result<ModelLibrary> library = train_library(*locations, quick_library_options());
  ASSERT_FALSE(library.ok());
  EXPECT_THAT(library.error().message, HasSubstr(locations->front().path.filename().string()));
}

TEST_F(MeshFolder, EveryModelIsReadBeforeTheFirstIsTrained) {
  const Result<std::vector<ModelLocation>> locations = find_models({folder_});
  ASSERT_TRUE(locations.ok());
  fs::resize_file(locations->back().path, 20);
  int num_begun = 0;
  const auto library =
      train_library(*locations, quick_library_options(), [&](int, int, const std::string&) { ++num_begun; });
  EXPECT_THAT(library.error().message, HasSubstr(locations->back().path.filename().string()));
  EXPECT_EQ(num_begun, 0);
}

TEST_F(MeshFolder, AnObjectAsLargeAsARoomGivesAWarning) {
  Result<std::vector<ModelLocation>> locations = find_models({folder_});
  ASSERT_TRUE(locations.ok()) << locations.error().message;
  (*locations)[0].metres_per_unit =
      3 / train_object("thing", make_any_object().mesh, quick_library_options())->diameter_m;
  TrainOptions options = quick_library_options();
  options.surface_voxel_m = 0.05;
  options.find_symmetries = false;
  std::vector<std::string> warnings;
  ASSERT_TRUE(train_library(*locations, options, {}, [&](const std::string& line) { warnings.push_back(line); }).ok());
  // The other object has its size.
  EXPECT_THAT(warnings, testing::Contains(HasSubstr("across")).Times(1));
  EXPECT_THAT(warnings, testing::Contains(HasSubstr("the object is 3.0 m across: is its unit right?")));
}

TEST(TrainLibrary, RefusesNothingAndNamesThatAreNotUnique) {
  EXPECT_THAT(train_library({}).error().message, HasSubstr("no models"));
  const std::vector<ModelLocation> twice{{.name = "mug", .bop_id = 0, .path = "/a/mug.ply", .format = "mesh"},
                                         {.name = "mug", .bop_id = 0, .path = "/b/mug.ply", .format = "mesh"}};
  EXPECT_THAT(train_library(twice).error().message, HasSubstr("two models are named 'mug': /a/mug.ply and /b/mug.ply"));
}

std::vector<ObjectModel> make_objects(const std::vector<std::pair<std::string, int>>& names_and_ids) {
  std::vector<ObjectModel> objects;
  for (const auto& [name, id] : names_and_ids) {
    objects.emplace_back();
    objects.back().name = name;
    objects.back().bop_id = id;
  }
  return objects;
}

TEST(AssignBopIds, KeepsGivenOnesAndFillsTheGaps) {
  std::vector<ObjectModel> objects = make_objects({{"a", 0}, {"b", 2}, {"c", 0}, {"d", 1}, {"e", 0}});
  ASSERT_TRUE(assign_bop_ids(objects).ok());
  std::vector<int> ids;
  for (const ObjectModel& object : objects) ids.push_back(object.bop_id);
  EXPECT_EQ(ids, (std::vector{3, 2, 4, 1, 5}));
}

TEST(AssignBopIds, RefusesConflicts) {
  const auto message = [](std::vector<ObjectModel> objects) {
    const Result<void> assigned = assign_bop_ids(objects);
    return assigned.ok() ? "fine" : assigned.error().message;
  };
  EXPECT_THAT(message(make_objects({{"a", 4}, {"b", 4}})), HasSubstr("'a' and 'b' have the same obj_id 4"));
  EXPECT_THAT(message(make_objects({{"a", -1}})), HasSubstr("obj_id -1"));
  EXPECT_THAT(message(make_objects({{"a", 0}, {"a", 0}})), HasSubstr("two models are named 'a'"));
  EXPECT_EQ(message({}), "fine");
}

TEST(TrainObjectFromSource, TakesOverWhatTheSourceKnows) {
  const ProceduralObject object = make_any_object();
  ModelSource source;
  source.name = "thing";
  source.bop_id = 17;
  source.symmetries.discrete.push_back(Rigid3::from_axis_angle({0, 0, 1}, 3.14159265358979));
  EXPECT_THAT(train_object(source).error().message,
              HasSubstr("'thing': neither training views nor a mesh nor a cloud"));
  source.mesh = object.mesh;
  const TrainOptions options = quick_library_options();
  const Result<ObjectModel> from_mesh = train_object(source, options);
  ASSERT_TRUE(from_mesh.ok()) << from_mesh.error().message;
  EXPECT_EQ(from_mesh->name, "thing");
  EXPECT_EQ(from_mesh->bop_id, 17);
  EXPECT_EQ(from_mesh->symmetries.discrete.size(), 1U);
  source.surface = train_surface("thing", *source.mesh, options).value();
  source.mesh.reset();
  const Result<ObjectModel> from_cloud = train_object(source, options);
  ASSERT_TRUE(from_cloud.ok()) << from_cloud.error().message;
  EXPECT_EQ(from_cloud->bop_id, 17);
  EXPECT_NEAR(from_cloud->diameter_m, from_mesh->diameter_m, 0.01);
}

TEST(TrainObjectFromSource, FindsSymmetriesUnlessTheyAreDeclared) {
  ModelSource source;
  source.name = "can";
  source.mesh = make_procedural_object("plain_can")->mesh;
  TrainOptions options = quick_library_options();
  const Result<ObjectModel> found = train_object(source, options);
  ASSERT_TRUE(found.ok()) << found.error().message;
  EXPECT_EQ(found->symmetries.continuous.size(), 1U);
  EXPECT_EQ(found->symmetries.discrete.size(), 1U);
  source.symmetries_known = true;
  EXPECT_TRUE(train_object(source, options)->symmetries.none());
  EXPECT_EQ(train_object(source, options)->shape_symmetries.continuous.size(), 1U);
  source.symmetries_known = false;
  options.find_symmetries = false;
  EXPECT_TRUE(train_object(source, options)->symmetries.none());
  EXPECT_TRUE(train_object(source, options)->shape_symmetries.none());
}

TEST(TrainObjectFromSource, FindsWhatOnlyTheTextureDistinguishes) {
  ModelSource source;
  source.name = "soup";
  source.mesh = make_procedural_object("soup_tomato")->mesh;
  const Result<ObjectModel> found = train_object(source, quick_library_options());
  ASSERT_TRUE(found.ok()) << found.error().message;
  EXPECT_TRUE(found->symmetries.none());
  EXPECT_EQ(found->shape_symmetries.continuous.size(), 1U);
}

// Procedural objects declare their symmetries. The sponge is skipped, because it is symmetric except for its pores.
TEST(TrainSurface, OfProceduralObjectsHasTheSymmetriesTheyWereDrawnWith) {
  int symmetric = 0;
  for (const std::string& name : procedural_object_names()) {
    if (name == "sponge") continue;
    SCOPED_TRACE(name);
    const ProceduralObject object = *make_procedural_object(name);
    const ObjectSymmetries found = find_symmetries(train_surface(name, object.mesh).value());
    ASSERT_EQ(found.continuous.size(), object.symmetries.continuous.size());
    ASSERT_EQ(found.discrete.size(), object.symmetries.discrete.size());
    symmetric += found.none() ? 0 : 1;
    for (std::size_t i = 0; i < found.continuous.size(); ++i)
      EXPECT_LT(found.continuous[i].direction.cross(object.symmetries.continuous[i].direction).norm(), 0.01);
    for (const Rigid3& motion : found.discrete)
      EXPECT_LT(symmetric_rotation_distance_rad(motion, Rigid3::identity(), object.symmetries), 0.02);
  }
  EXPECT_EQ(symmetric, 5);
}

TEST(TrainObjectFromMesh, WithoutAnyColourOnlyItsShapeCounts) {
  ProceduralObject object = make_any_object();
  object.mesh.texture = {};
  object.mesh.uvs.clear();
  object.mesh.colors.clear();
  const Result<ObjectModel> bare = train_object("thing", object.mesh, quick_library_options());
  ASSERT_TRUE(bare.ok()) << bare.error().message;
  EXPECT_TRUE(bare->surface.colors.empty());
  EXPECT_EQ(bare->sift.size(), 0U);
  object.mesh.colors.assign(object.mesh.vertices.size(), Rgb8{200, 30, 20});
  const Result<ObjectModel> red = train_object("thing", object.mesh, quick_library_options());
  ASSERT_TRUE(red.ok()) << red.error().message;
  EXPECT_TRUE(red->surface.has_colors()) << "a uniform mesh colour is intentional";
  EXPECT_EQ(red->shot.points, bare->shot.points);
  ModelLibrary library;
  library.objects = {*bare, *red};
  library.objects[1].name = "other";
  library.objects[0].bop_id = 1;
  library.objects[1].bop_id = 2;
  const fs::path file = fs::temp_directory_path() / ("resight_bare_" + std::to_string(getpid()));
  ASSERT_TRUE(save_library(library, file).ok());
  const Result<ModelLibrary> loaded = load_library(file);
  fs::remove(file);
  ASSERT_TRUE(loaded.ok()) << loaded.error().message;
  EXPECT_TRUE(loaded->objects[0].surface.colors.empty());
  EXPECT_EQ(loaded->objects[0].surface.points, bare->surface.points);
  EXPECT_EQ(loaded->objects[1].surface.colors, red->surface.colors);
}

TEST(TrainObjectFromViews, OneColourInAllPixelsIsNone) {
  std::vector<TrainingView> views = render_turntable(make_any_object().mesh, quick_library_options().turntable);
  for (TrainingView& view : views) view.frame.color = Image<Rgb8>(640, 480, Rgb8{0, 0, 255});
  const Result<ObjectModel> model = train_object("thing", views, quick_library_options());
  ASSERT_TRUE(model.ok()) << model.error().message;
  EXPECT_TRUE(model->surface.colors.empty());
  EXPECT_GT(model->surface.size(), 1000U);
  EXPECT_EQ(model->sift.size(), 0U);
  views[1].frame.color(0, 0) = {1, 2, 3};  // beside the object
  EXPECT_TRUE(train_object("thing", views, quick_library_options())->surface.colors.empty());
  for (std::size_t i = 0; i < views[1].mask.size(); ++i)
    if (views[1].mask[i] != 0) views[1].frame.color[i] = {1, 2, 3};
  EXPECT_TRUE(train_object("thing", views, quick_library_options())->surface.has_colors());
}

ModelSource make_source_of_one_view(const ProceduralObject& object, const TrainOptions& options) {
  ModelSource source;
  source.name = "thing";
  source.views = render_turntable(object.mesh, options.turntable);
  source.views.resize(1);
  return source;
}

TEST(TrainObjectFromSource, PrefersViewsForFeaturesAndTheMeshForTheSurface) {
  const ProceduralObject object = make_any_object();
  const TrainOptions options = quick_library_options();
  ModelSource source = make_source_of_one_view(object, options);
  const Result<ObjectModel> from_views = train_object(source, options);
  ASSERT_TRUE(from_views.ok()) << from_views.error().message;
  source.surface = train_surface("thing", object.mesh, options).value();
  const Result<ObjectModel> with_cloud = train_object(source, options);
  source.surface->normals.clear();
  const Result<ObjectModel> with_bare_cloud = train_object(source, options);
  source.mesh = object.mesh;
  const Result<ObjectModel> with_mesh = train_object(source, options);
  ASSERT_TRUE(with_cloud.ok() && with_bare_cloud.ok() && with_mesh.ok());
  EXPECT_EQ(with_mesh->sift.codes, from_views->sift.codes);
  EXPECT_EQ(with_cloud->shot.codes, from_views->shot.codes);
  EXPECT_GT(with_mesh->surface.size(), from_views->surface.size());
  EXPECT_GT(with_cloud->surface.size(), from_views->surface.size());
  EXPECT_NEAR(static_cast<double>(with_bare_cloud->surface.size()), static_cast<double>(with_cloud->surface.size()),
              0.01 * static_cast<double>(with_cloud->surface.size()));
  EXPECT_GT(with_cloud->diameter_m, 0);
  EXPECT_GT(with_mesh->diameter_m, 0);
}

TEST(TrainObjectFromSource, TheViewsDecideWhetherASurfaceOfOneColourHasIt) {
  const ProceduralObject object = make_any_object();
  const TrainOptions options = quick_library_options();
  ModelSource source = make_source_of_one_view(object, options);
  source.surface = train_surface("thing", object.mesh, options).value();
  source.surface->colors.assign(source.surface->size(), Rgb8{200, 30, 20});
  const Result<ObjectModel> plain = train_object(source, options);
  ASSERT_TRUE(plain.ok()) << plain.error().message;
  ASSERT_TRUE(plain->surface.has_colors());
  EXPECT_EQ(plain->surface.colors.front(), (Rgb8{200, 30, 20}));
  source.views[0].frame.color = Image<Rgb8>(640, 480, Rgb8{0, 0, 255});
  const Result<ObjectModel> labelled = train_object(source, options);
  ASSERT_TRUE(labelled.ok()) << labelled.error().message;
  EXPECT_FALSE(labelled->surface.has_colors());
}

}  // namespace
}  // namespace resight
