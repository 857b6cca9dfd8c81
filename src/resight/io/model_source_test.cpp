// SPDX-License-Identifier: Apache-2.0
#include "resight/io/model_source.hpp"

#include <gmock/gmock.h>

#include "resight/io/internal/test_data.hpp"
#include "resight/io/pcd.hpp"
#include "resight/io/ply.hpp"
#include "resight/io/tuw_models.hpp"

namespace resight {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

std::vector<std::string> names_of(const Result<std::vector<ModelLocation>>& found) {
  EXPECT_TRUE(found.ok()) << (found.ok() ? "" : found.error().message);
  std::vector<std::string> names;
  if (found.ok())
    for (const auto& location : *found) names.push_back(location.name + ":" + location.format);
  return names;
}

TriangleMesh mesh() {
  TriangleMesh mesh;
  mesh.vertices = {{0, 0, 0}, {0.1F, 0, 0}, {0, 0.2F, 0}};
  mesh.faces = {{0, 1, 2}};
  compute_vertex_normals(mesh);
  return mesh;
}

TEST(FindModels, EveryKindOfFolder) {
  io::TestDirectory directory;
  const std::vector<TrainingView> views = {io::random_training_view("0", 1)};
  ASSERT_TRUE(write_tuw_model(directory / "tuw", "mug", views, nullptr).ok());
  ASSERT_TRUE(write_tuw_model(directory / "tuw/kitchen", "pot", views, nullptr).ok());
  EXPECT_THAT(names_of(find_models({directory / "tuw"})), ElementsAre("mug:tuw", "pot:tuw"));
  EXPECT_THAT(names_of(find_models({directory / "tuw/mug"})), ElementsAre("mug:tuw"));
  ASSERT_TRUE(write_ply(directory / "meshes/box.ply", mesh()).ok());
  io::write_text(directory / "meshes/box.obj", "");
  ASSERT_TRUE(write_ply(directory / "meshes/apple_2/textured.ply", mesh()).ok());
  ASSERT_TRUE(write_ply(directory / "meshes/apple_10/anything.ply", mesh()).ok());
  EXPECT_THAT(names_of(find_models({directory / "meshes"})), ElementsAre("apple_2:mesh", "apple_10:mesh", "box:mesh"));
  EXPECT_EQ(find_models({directory / "meshes"})->back().path.extension(), ".obj")
      << "must prefer the richest format of a stem";
  EXPECT_THAT(names_of(find_models({directory / "meshes/box.ply", directory / "tuw/mug"})),
              ElementsAre("box:mesh", "mug:tuw"));
  EXPECT_THAT(find_models({directory / "meshes", directory / "meshes/box.ply"}).error().message,
              HasSubstr("two models are called 'box'"));
}

// Simulated data sets have meshes of things that are in no library.
TEST(FindModels, UnknownObjectsAreNotFound) {
  io::TestDirectory directory;
  const std::vector<TrainingView> views = {io::random_training_view("0", 1)};
  ASSERT_TRUE(write_tuw_model(directory / "models", "mug", views, nullptr).ok());
  ASSERT_TRUE(write_ply(directory / "unknown/models/obj_000001.ply", mesh()).ok());
  io::write_text(directory / "unknown/models/models_info.json", R"({"1": {"name": "vase"}})");
  EXPECT_THAT(names_of(find_models({directory.path()})), ElementsAre("mug:tuw"));
  EXPECT_THAT(names_of(find_models({directory / "unknown/models"})), ElementsAre("vase:bop"));
}

TEST(FindModels, NothingThere) {
  io::TestDirectory directory;
  EXPECT_THAT(find_models({}).error().message, HasSubstr("no path"));
  EXPECT_THAT(find_models({directory / "none"}).error().message, HasSubstr("no such file or directory"));
  EXPECT_THAT(find_models({directory.path()}).error().message, HasSubstr("views/cloud_*.pcd"));
  io::write_text(directory / "a.txt", "x");
  EXPECT_THAT(find_models({directory / "a.txt"}).error().message, HasSubstr("no model file"));
}

TEST(TuwModel, ComesBack) {
  io::TestDirectory directory;
  const std::vector<TrainingView> views = {io::random_training_view("cloud_4", 1),
                                           io::random_training_view("cloud_9", 2)};
  PointCloud surface;
  surface.points = {{0, 0, 0}, {0.1F, 0, 0}, {0, 0.1F, 0.05F}};
  surface.colors = {{1, 2, 3}, {4, 5, 6}, {7, 8, 9}};
  surface.normals = {{0, 0, 1}, {0, 1, 0}, {1, 0, 0}};
  ObjectSymmetries symmetries;
  symmetries.continuous.push_back({});
  ASSERT_TRUE(write_tuw_model(directory.path(), "mug", views, &surface, symmetries, 12).ok());
  const auto model = read_model(find_models({directory.path()})->front());
  ASSERT_TRUE(model.ok()) << model.error().message;
  EXPECT_EQ(model->bop_id, 12);
  EXPECT_EQ(model->symmetries.continuous.size(), 1U);
  EXPECT_TRUE(model->symmetries_known);
  ASSERT_TRUE(model->surface.has_value());
  EXPECT_EQ(model->surface->points, surface.points);
  EXPECT_EQ(model->surface->colors, surface.colors);
  ASSERT_EQ(model->views.size(), 2U);
  EXPECT_EQ(model->views[1].frame.name, "cloud_00000009");
  for (int i = 0; i < 2; ++i) {
    EXPECT_EQ(model->views[i].mask, views[i].mask);
    EXPECT_EQ(model->views[i].frame.color, views[i].frame.color);
    EXPECT_EQ(io::depth_difference_m(model->views[i].frame.depth_m, views[i].frame.depth_m), 0);
    EXPECT_EQ(io::pose_difference(model->views[i].frame.world_from_camera, views[i].frame.world_from_camera), 0);
  }
  EXPECT_THAT(write_tuw_model(directory.path(), "mug", views, nullptr).error().message, HasSubstr("exists already"));
}

TEST(TuwModel, CloudsWithZBackwardAreTurned) {
  io::TestDirectory directory;
  const std::vector<TrainingView> views = {io::random_training_view("0", 1)};
  ASSERT_TRUE(write_tuw_model(directory.path(), "mug", views, nullptr).ok());
  const auto file = directory / "mug/views/cloud_00000000.pcd";
  auto cloud = read_pcd(file);
  ASSERT_TRUE(cloud.ok()) << cloud.error().message;
  for (Eigen::Vector3f& p : cloud->points) p = {p.x(), -p.y(), -p.z()};
  ASSERT_TRUE(write_pcd(file, *cloud).ok());
  const auto model = read_model(find_models({directory / "mug"})->front());
  ASSERT_TRUE(model.ok()) << model.error().message;
  const RgbdFrame& frame = model->views.at(0).frame;
  EXPECT_EQ(io::depth_difference_m(frame.depth_m, views[0].frame.depth_m), 0);
  const Rigid3 turn = Rigid3::from_rotation(Eigen::Vector3d(1, -1, -1).asDiagonal());
  EXPECT_LT(io::pose_difference(frame.world_from_camera, views[0].frame.world_from_camera * turn), 1e-12);
}

TEST(FindModels, YcbObjectsAreNamedByTheirFolder) {
  io::TestDirectory directory;
  for (const char* object : {"003_cracker_box", "005_tomato_soup_can"})
    for (const char* variant : {"google_16k", "tsdf"}) {
      ASSERT_TRUE(write_ply(directory / "ycb" / object / variant / "textured.ply", mesh()).ok());
      ASSERT_TRUE(write_ply(directory / "ycb" / object / variant / "nontextured.ply", mesh()).ok());
    }
  const auto found = find_models({directory / "ycb"});
  ASSERT_TRUE(found.ok()) << found.error().message;
  ASSERT_EQ(found->size(), 2U);
  EXPECT_EQ((*found)[0].name, "003_cracker_box");
  EXPECT_EQ((*found)[0].path, directory / "ycb/003_cracker_box/google_16k/textured.ply");
  EXPECT_EQ((*found)[1].name, "005_tomato_soup_can");
  for (const char* one :
       {"ycb/003_cracker_box", "ycb/003_cracker_box/google_16k", "ycb/003_cracker_box/google_16k/textured.ply"})
    EXPECT_EQ(find_models({directory / one})->front().name, "003_cracker_box") << one;
  const auto files = find_models({directory / "ycb/003_cracker_box/google_16k/textured.ply",
                                  directory / "ycb/005_tomato_soup_can/google_16k/textured.ply"});
  ASSERT_TRUE(files.ok()) << files.error().message;
  EXPECT_EQ((*files)[1].name, "005_tomato_soup_can");
}

TEST(ModelSource, SymmetriesAreKnownWhereTheFileNamesThem) {
  io::TestDirectory directory;
  ASSERT_TRUE(write_ply(directory / "box/box.ply", mesh()).ok());
  const auto are_known = [&] { return read_model(find_models({directory.path()})->front())->symmetries_known; };
  EXPECT_FALSE(are_known());
  io::write_text(directory / "box/model_info.json", R"({"obj_id": 3})");
  EXPECT_FALSE(are_known());
  io::write_text(directory / "box/model_info.json", R"({"obj_id": 3, "symmetries_discrete": []})");
  EXPECT_TRUE(are_known());
}

// In the folder of one mesh or cloud, however the model is named. Beside several models it does not say which is meant.
TEST(ModelSource, ModelInfoBesideAMeshOrCloud) {
  io::TestDirectory directory;
  ASSERT_TRUE(write_ply(directory / "meshes/box/a.ply", mesh()).ok());
  PointCloud cloud;
  cloud.points = {{0, 0, 0}, {0.1F, 0, 0}, {0, 0.1F, 0.05F}};
  ASSERT_TRUE(write_ply(directory / "clouds/box/a.ply", cloud).ok());
  const std::string info = R"({"obj_id": 7, "symmetries_continuous": [{"axis": [0, 0, 1], "offset": [0, 0, 0]}]})";
  const auto expect = [&](const std::string& where, int bop_id) {
    const auto found = find_models({directory / where});
    ASSERT_TRUE(found.ok()) << found.error().message;
    EXPECT_EQ(found->front().bop_id, bop_id) << where;
    const auto model = read_model(found->front());
    ASSERT_TRUE(model.ok()) << model.error().message;
    EXPECT_EQ(model->bop_id, bop_id) << where;
    EXPECT_EQ(model->symmetries_known, bop_id > 0) << where;
    EXPECT_EQ(model->symmetries.continuous.size(), bop_id > 0 ? 1U : 0U) << where;
    EXPECT_EQ(model->warnings.size(), bop_id > 0 ? 0U : 1U) << where;
  };
  for (const std::string kind : {"meshes", "clouds"}) {
    io::write_text(directory / kind / "box/model_info.json", info);
    for (const char* where : {"", "/box", "/box/a.ply"}) expect(kind + where, 7);
    ASSERT_TRUE(write_ply(directory / kind / "box/b.ply", mesh()).ok());
    for (const char* where : {"", "/box", "/box/a.ply"}) expect(kind + where, 0);
  }
  const std::vector<TrainingView> views = {io::random_training_view("0", 1)};
  ASSERT_TRUE(write_tuw_model(directory.path(), "mug", views, &cloud).ok());
  ASSERT_TRUE(write_ply(directory / "mug/mesh.ply", mesh()).ok());
  io::write_text(directory / "mug/model_info.json", info);
  expect("mug/mesh.ply", 7);
}

TEST(TuwModel, DamagedCompanions) {
  io::TestDirectory directory;
  const std::vector<TrainingView> views = {io::random_training_view("0", 1)};
  ASSERT_TRUE(write_tuw_model(directory.path(), "mug", views, nullptr).ok());
  const ModelLocation location = find_models({directory / "mug"})->front();
  const auto message = [&] {
    const auto model = read_model(location);
    return model.ok() ? std::string("no error") : model.error().message;
  };
  io::write_text(directory / "mug/views/object_indices_00000000.txt", "5\n99999\n");
  EXPECT_THAT(message(), HasSubstr("object_indices_00000000.txt: '99999'"));
  std::filesystem::remove(directory / "mug/views/object_indices_00000000.txt");
  EXPECT_THAT(message(), HasSubstr("object_indices_00000000.txt: no such file"));
  std::filesystem::remove(directory / "mug/views/pose_00000000.txt");
  EXPECT_THAT(message(), HasSubstr("pose_00000000.txt: no such file"));
}

TEST(CloudModel, OneViewInFrontOfTheCamera) {
  io::TestDirectory directory;
  PcdCloud pcd;
  for (int v = 0; v < 40; ++v)
    for (int u = 0; u < 40; ++u) {
      const Eigen::Vector3d p = make_kinect_camera().unproject(300 + u, 200 + v, 0.8);
      pcd.points.push_back(p.cast<float>());
      pcd.colors.push_back({static_cast<std::uint8_t>(u), static_cast<std::uint8_t>(v), 0});
    }
  pcd.width = 1600;
  pcd.height = 1;
  ASSERT_TRUE(write_pcd(directory / "can.pcd", pcd).ok());
  const auto found = find_models({directory.path()});
  EXPECT_THAT(names_of(found), ElementsAre("can:cloud"));
  const auto model = read_model(found->front());
  ASSERT_TRUE(model.ok()) << model.error().message;
  ASSERT_EQ(model->views.size(), 1U);
  const TrainingView& view = model->views[0];
  EXPECT_EQ(count_valid(view.frame.depth_m), 1600U);
  EXPECT_EQ(std::ranges::count(view.mask.data(), 255), 1600);
  EXPECT_EQ(view.frame.color(307, 211), (Rgb8{7, 11, 0}));
  pcd.colors.clear();
  ASSERT_TRUE(write_pcd(directory / "can.pcd", pcd).ok());
  const auto colorless = read_model(found->front());
  ASSERT_TRUE(colorless.ok()) << colorless.error().message;
  EXPECT_EQ(count_valid(colorless->views.at(0).frame.depth_m), 1600U);
  for (auto& p : pcd.points) p *= 1e3F;
  ASSERT_TRUE(write_pcd(directory / "can.pcd", pcd).ok());
  EXPECT_THAT(read_model(found->front()).error().message, HasSubstr("looks like millimetres"));
  ModelLocation in_millimetres = found->front();
  in_millimetres.metres_per_unit = 1e-3;
  const auto scaled = read_model(in_millimetres);
  ASSERT_TRUE(scaled.ok()) << scaled.error().message;
  EXPECT_EQ(scaled->views.at(0).frame.depth_m.data().size(), colorless->views[0].frame.depth_m.data().size());
  EXPECT_NEAR(scaled->views[0].frame.depth_m(310, 210), 0.8, 1e-5);
}

TEST(ModelSource, RefusesViewsThatAreFarFromTheOrigin) {
  for (const double x_m : {60.0, 5000.0}) {
    io::TestDirectory directory;
    std::vector<TrainingView> views = {io::random_training_view("cloud_4", 1)};
    views[0].frame.world_from_camera.translation.x() = x_m;
    ASSERT_TRUE(write_tuw_model(directory.path(), "mug", views, nullptr, {}).ok());
    const auto model = read_model(find_models({directory / "mug"})->front());
    EXPECT_EQ(model.ok(), x_m < 100);
    if (model.ok()) continue;
    EXPECT_THAT(model.error().message, HasSubstr("mug: the object is "));
    EXPECT_THAT(model.error().message,
                HasSubstr("m away from its origin (at most 100 m): move it there (view 'cloud_"));
  }
}

TEST(ModelSource, RefusesSymmetriesThatNoLibraryMayHave) {
  io::TestDirectory directory;
  const std::vector<TrainingView> views = {io::random_training_view("cloud_4", 1)};
  ASSERT_TRUE(write_tuw_model(directory.path(), "mug", views, nullptr, {}).ok());
  const auto read_with = [&](const std::string& symmetries) {
    io::write_text(directory / "mug/model_info.json", "{" + symmetries + "}");
    const auto found = find_models({directory / "mug"});
    return found.ok() ? read_model(found->front()) : found.error();
  };
  const auto read_axis = [&](const std::string& axis, const std::string& offset) {
    return read_with(R"("symmetries_continuous": [{"axis": )" + axis + R"(, "offset": )" + offset + "}]");
  };
  const auto huge = read_axis("[0, 0, 1e200]", "[0, 0, 99000]");
  ASSERT_TRUE(huge.ok()) << huge.error().message;
  EXPECT_EQ(huge->symmetries.continuous.at(0).direction, Eigen::Vector3d::UnitZ());
  const std::string expected = "model_info.json: symmetries_continuous: an offset is 900 m long (at most 100 m";
  EXPECT_THAT(read_axis("[0, 0, 1]", "[0, 900000, 0]").error().message, HasSubstr(expected));
  EXPECT_FALSE(read_axis("[0, 0, 1]", "[0, 1e300, 0]").ok());
  const auto moved = read_with(R"("symmetries_discrete": [[1,0,0,900000, 0,1,0,0, 0,0,1,0, 0,0,0,1]])");
  EXPECT_THAT(moved.error().message, HasSubstr("symmetries_discrete: a translation is 900 m long (at most 200 m"));

  // Motions of several axes are multiplied: those of six would fill the memory.
  const auto read_axes = [&](int count) {
    std::string axes = R"({"axis": [0, 0, 1], "offset": [0, 0, 0]})";
    for (int i = 1; i < count; ++i) axes += R"(, {"axis": [0, 1, 0], "offset": [0, 0, 0]})";
    return read_with(R"("symmetries_continuous": [)" + axes + "]");
  };
  EXPECT_TRUE(read_axes(2).ok());
  EXPECT_THAT(read_axes(6).error().message, HasSubstr("more than 20000 symmetry motions"));
}

// All sides of a ball, around the origin or in front of the camera. In a single view, no point hides another.
TEST(CloudModel, AllSidesOfAnObjectAreItsSurface) {
  for (const float z : {0.0F, 0.8F}) {
    io::TestDirectory directory;
    Rng rng(1);
    PointCloud ball;
    for (int i = 0; i < 4000; ++i) {
      const Eigen::Vector3d n = Eigen::Vector3d{rng.normal(), rng.normal(), rng.normal()}.normalized();
      ball.points.emplace_back((0.05 * n).cast<float>() + Eigen::Vector3f(0, 0, z));
      ball.colors.push_back({200, 100, 50});
    }
    ASSERT_TRUE(write_ply(directory / "ball.ply", ball).ok());
    const auto model = read_model(find_models({directory / "ball.ply"})->front());
    ASSERT_TRUE(model.ok()) << model.error().message;
    EXPECT_TRUE(model->views.empty());
    ASSERT_TRUE(model->surface.has_value()) << z;
    EXPECT_EQ(model->surface->size(), 4000U);
    std::erase_if(ball.points, [&](const Eigen::Vector3f& p) { return p.z() > z - 0.01F; });  // keep the visible side
    ball.colors.resize(ball.points.size());
    ASSERT_TRUE(write_ply(directory / "ball.ply", ball).ok());
    const auto half = read_model(find_models({directory / "ball.ply"})->front());
    ASSERT_TRUE(half.ok()) << half.error().message;
    EXPECT_EQ(half->views.size(), z > 0 ? 1U : 0U);
  }
}

}  // namespace
}  // namespace resight
