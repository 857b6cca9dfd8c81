// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "resight/io/bop_models.hpp"
#include "resight/io/images.hpp"
#include "resight/io/internal/test_data.hpp"

namespace resight {
namespace {

using testing::HasSubstr;

/// A scene of `num_views` images of 4x3 pixels. Camera and ground truth are written as text, as by other tools.
void write_scene(const std::filesystem::path& scene, int num_views, bool with_poses) {
  nlohmann::json cameras;
  nlohmann::json truth;
  for (int i = 0; i < num_views; ++i) {
    const std::string number = std::string("00000") + std::to_string(2 * i + 1);
    ASSERT_TRUE(write_color(scene / "rgb" / (number + ".jpg"), Image<Rgb8>(4, 3, Rgb8{90, 90, 90})).ok());
    ASSERT_TRUE(write_depth(scene / "depth" / (number + ".png"), Image<float>(4, 3, 0.5F), 2e-4).ok());
    const std::string key = std::to_string(2 * i + 1);
    cameras[key] = {{"cam_K", {500, 0, 1.5, 0, 501, 1.25, 0, 0, 1}}, {"depth_scale", 0.2}};
    if (with_poses) cameras[key]["cam_R_w2c"] = {0, -1, 0, 1, 0, 0, 0, 0, 1};
    if (with_poses) cameras[key]["cam_t_w2c"] = {0, 0, 1000};
    for (const int id : {5, 5, 7})
      truth[key].push_back({{"obj_id", id}, {"cam_R_m2c", {1, 0, 0, 0, 1, 0, 0, 0, 1}}, {"cam_t_m2c", {10, 20, 500}}});
  }
  io::write_text(scene / "scene_camera.json", cameras.dump());
  io::write_text(scene / "scene_gt.json", truth.dump());
  io::write_text(scene / "scene_gt_info.json", R"({"1": [{"visib_fract": 0.5}, {"visib_fract": -1}]})");
}

TEST(BopScene, ReadsUnitsNamesAndPoses) {
  io::TestDirectory directory;
  write_scene(directory / "test/000012", 2, true);
  io::write_text(directory / "models/models_info.json",
                 R"({"5": {"diameter": 1, "name": "mug"}, "7": {"diameter": 1}})");
  const auto sequence = open_sequence(directory.path());
  ASSERT_TRUE(sequence.ok()) << sequence.error().message;
  EXPECT_EQ((*sequence)->format(), "bop");
  EXPECT_EQ((*sequence)->scene_id(), 12);
  ASSERT_EQ((*sequence)->num_views(), 2);
  EXPECT_EQ((*sequence)->image_id(1), 3);
  EXPECT_EQ((*sequence)->view_name(1), "000003");
  EXPECT_TRUE((*sequence)->has_poses());
  const auto frame = (*sequence)->read_view(0);
  ASSERT_TRUE(frame.ok()) << frame.error().message;
  EXPECT_EQ(frame->camera, (Camera{4, 3, 500, 501, 1.5, 1.25}));
  EXPECT_NEAR(frame->depth_m(1, 1), 0.5, 1e-7);
  // w2c rotates x to y and shifts by 1 m forward, so that the camera is 1 m behind the origin.
  EXPECT_LT((frame->world_from_camera.translation - Eigen::Vector3d(0, 0, -1)).norm(), 1e-12);
  EXPECT_LT((frame->world_from_camera.rotation * Eigen::Vector3d::UnitY() - Eigen::Vector3d::UnitX()).norm(), 1e-12);
  const auto truth = (*sequence)->read_ground_truth(0);
  ASSERT_EQ(truth->size(), 3U);
  EXPECT_EQ((*truth)[1].object, "mug");
  EXPECT_EQ((*truth)[1].instance, 1);
  EXPECT_EQ((*truth)[2].object, "obj_000007");
  EXPECT_EQ((*truth)[2].bop_id, 7);
  EXPECT_EQ((*truth)[0].visible_share, 0.5);
  EXPECT_TRUE(std::isnan((*truth)[1].visible_share));
  EXPECT_LT(((*truth)[0].camera_from_object.translation - Eigen::Vector3d(0.01, 0.02, 0.5)).norm(), 1e-12);
}

TEST(BopScene, GivenIntrinsicsMustFitTheImages) {
  io::TestDirectory directory;
  write_scene(directory / "scene", 1, true);
  OpenSequenceOptions options;
  options.intrinsics = (directory / "k.yaml").string();
  const auto open = [&](const std::string& size) {
    io::write_text(directory / "k.yaml", "fx: 510\nfy: 510\ncx: 1.5\ncy: 1\ndepth_scale: 0.001\n" + size);
    return open_sequence(directory / "scene", options);
  };
  EXPECT_THAT(open("width: 8\nheight: 6\n").error().message,
              HasSubstr("--intrinsics: the intrinsics are for images of 8x6, but these have 4x3"));
  const auto sequence = open("width: 4\nheight: 3\n");
  ASSERT_TRUE(sequence.ok()) << sequence.error().message;
  EXPECT_EQ((*sequence)->read_view(0)->camera.fx, 510);
  EXPECT_NEAR((*sequence)->read_view(0)->depth_m(1, 1), 0.5, 1e-7);
  EXPECT_THAT((*sequence)->notes(), testing::Contains(HasSubstr("the unit of depth in k.yaml (0.001 m) is not used")));
  options.depth_scale_m = 0.0002;
  EXPECT_THAT((*open(""))->notes(), testing::IsEmpty());
  options.intrinsics = "510,510,5,1";
  EXPECT_THAT(open("").error().message, HasSubstr("the centre (5, 1) lies outside the images of 4x3"));
}

TEST(BopScene, NotesImagesThatNoCameraNames) {
  io::TestDirectory directory;
  write_scene(directory / "scene", 2, true);
  EXPECT_TRUE((*open_sequence(directory / "scene"))->notes().empty());
  ASSERT_TRUE(write_depth(directory / "scene/depth/000009.png", Image<float>(4, 3, 0.5F), 2e-4).ok());
  const auto notes = (*open_sequence(directory / "scene"))->notes();
  ASSERT_EQ(notes.size(), 1U);
  EXPECT_EQ(notes[0], "1 depth images, such as 000009.png, are not in scene_camera.json and are left out");
}

TEST(BopScene, SeveralScenesAreAmbiguous) {
  io::TestDirectory directory;
  write_scene(directory / "test/000001", 1, true);
  write_scene(directory / "train/000005", 1, true);
  EXPECT_TRUE(open_sequence(directory.path()).ok()) << "must ignore training scenes beside test scenes";
  write_scene(directory / "test/000002", 1, true);
  EXPECT_THAT(open_sequence(directory.path()).error().message, HasSubstr("holds 2 sequences"));
  EXPECT_THAT(open_sequence(directory / "test").error().message, HasSubstr("holds 2 sequences"));
}

TEST(BopScene, MissingPosesAreAnErrorForSeveralViews) {
  io::TestDirectory directory;
  write_scene(directory / "one", 1, false);
  write_scene(directory / "two", 2, false);
  const auto one = open_sequence(directory / "one");
  ASSERT_TRUE(one.ok()) << one.error().message;
  EXPECT_FALSE((*one)->has_poses());
  EXPECT_EQ((*one)->read_view(0)->world_from_camera.translation, Eigen::Vector3d::Zero());
  EXPECT_TRUE(open_posed_sequence(directory / "one").ok());
  ASSERT_TRUE(open_sequence(directory / "two").ok());
  EXPECT_FALSE((*open_sequence(directory / "two"))->has_poses());
  EXPECT_THAT(open_posed_sequence(directory / "two").error().message, HasSubstr("no camera poses"));
}

TEST(BopScene, BadContent) {
  io::TestDirectory directory;
  const auto scene = directory / "000001";
  write_scene(scene, 1, true);
  const auto message_with = [&](const std::string& file, const std::string& text) {
    const std::string before = io::read_text(scene / file);
    io::write_text(scene / file, text);
    const auto sequence = open_sequence(scene);
    io::write_text(scene / file, before);
    return sequence.ok() ? std::string("no error") : sequence.error().message;
  };
  EXPECT_THAT(message_with("scene_camera.json", "{"), HasSubstr("not valid JSON"));
  EXPECT_THAT(message_with("scene_camera.json", "[]"), HasSubstr("JSON object"));
  EXPECT_THAT(message_with("scene_camera.json", "{}"), HasSubstr("no image"));
  EXPECT_THAT(message_with("scene_camera.json", R"({"x": {}})"), HasSubstr("no number"));
  EXPECT_THAT(message_with("scene_camera.json", R"({"9": {}})"), HasSubstr("colour image is missing"));
  EXPECT_THAT(message_with("scene_camera.json", R"({"1": {"cam_K": [0,0,1,0,5,1,0,0,1]}})"), HasSubstr("focal"));
  EXPECT_THAT(message_with("scene_camera.json", R"({"1": {"cam_K": "x"}})"), HasSubstr("9 numbers"));
  for (const char* scale : {"0", "1e-322", "1e7", "\"1\""})
    EXPECT_THAT(message_with("scene_camera.json",
                             std::string(R"({"1": {"cam_K": [5,0,1,0,5,1,0,0,1], "depth_scale": )") + scale + "}}"),
                HasSubstr("image 1: depth_scale must be a number from"))
        << scale;
  EXPECT_THAT(message_with("scene_camera.json", R"({"1": {}, "1": {}})"), HasSubstr("the key '1' twice"));
  EXPECT_THAT(message_with("scene_camera.json", R"({"1": {}, "01": {}})"), HasSubstr("several keys are the number 1"));
  EXPECT_THAT(message_with("scene_camera.json", "{\n\"1\": NaN}"), HasSubstr("line 2 (NaN and infinite"));
  EXPECT_THAT(message_with("scene_camera.json", "{\"1\": -Infinity}"), HasSubstr("(NaN and infinite"));
  EXPECT_THAT(message_with("scene_camera.json", "{\"1\": "), HasSubstr("line 1 (cut off?)"));
  EXPECT_THAT(message_with("scene_camera.json", "{\"1\": 1e999}"), HasSubstr("a number is too large"));
  EXPECT_THAT(message_with("scene_camera.json",
                           R"({"1": {"cam_K": [5,0,1,0,5,1,0,0,1], "cam_R_w2c": [1,0,0,0,1,0,0,0,1],
                               "cam_t_w2c": [0, 0, 1e300]}})"),
              HasSubstr("away from the origin"));
  EXPECT_THAT(message_with("scene_gt.json", "[]"), HasSubstr("scene_gt.json: expected a JSON object"));
  for (const char* name : {"", "../../x", "a\\nb"})
    EXPECT_THAT(message_with("scene_gt.json", std::string(R"({"1": [{"obj_id": 99, "name": ")") + name +
                                                  R"(", "cam_R_m2c": [1,0,0,0,1,0,0,0,1], "cam_t_m2c": [0,0,0]}]})"),
                HasSubstr("image 1: the name of an object"))
        << name;
  EXPECT_THAT(message_with("scene_gt.json", R"({"1": {}})"), HasSubstr("list of objects"));
  EXPECT_THAT(message_with("scene_gt.json", R"({"1": [{"obj_id": 1.5}]})"), HasSubstr("obj_id"));
  EXPECT_THAT(message_with("scene_gt.json",
                           R"({"1": [{"obj_id": 1, "cam_R_m2c": [2,0,0,0,2,0,0,0,2], "cam_t_m2c": [0,0,0]}]})"),
              HasSubstr("rigid"));
  ASSERT_TRUE(write_depth(scene / "depth/000001.png", Image<float>(3, 3, 0.5F), 1e-3).ok());
  EXPECT_THAT((*open_sequence(scene))->read_view(0).error().message, HasSubstr("000001.png: is 3x3"));
  std::filesystem::remove(scene / "depth/000001.png");
  EXPECT_THAT(open_sequence(scene).error().message, HasSubstr("depth image is missing"));
}

TEST(BopScene, TruthThatCannotBeReadIsNotAbsent) {
  io::TestDirectory directory;
  const auto scene = directory / "000001";
  write_scene(scene, 1, true);
  std::filesystem::remove(scene / "scene_gt.json");
  EXPECT_FALSE((*open_sequence(scene))->has_ground_truth());
  std::filesystem::create_symlink("nowhere", scene / "scene_gt.json");
  EXPECT_THAT(open_sequence(scene).error().message, HasSubstr("scene_gt.json"));
}

TEST(BopScene, WriterTakesIdsOfTheModels) {
  io::TestDirectory directory;
  io::write_text(directory / "models/models_info.json", R"({"1": {"name": "box"}, "4": {"name": "mug"}})");
  const auto writer = create_sequence(directory / "test/000003", DatasetFormat::kBop);
  ASSERT_TRUE(writer.ok()) << writer.error().message;
  const std::vector<GroundTruthObject> truth = {
      {"mug", 0, 0, {}, 0.5}, {"new", 0, 0, {}, std::nan("")}, {"mug", 4, 7, {}, 1}};
  ASSERT_TRUE((*writer)->write_view(io::random_frame("cloud_05", 1), truth).ok());
  ASSERT_TRUE((*writer)->write_view(io::random_frame("cloud_05", 2), {}).ok());
  EXPECT_THAT((*writer)->write_view(io::random_frame("v9", 2), {{"box", 4, 0, {}, 1}}).error().message,
              HasSubstr("has the ids 1 and 4"));
  ASSERT_TRUE((*writer)->finish().ok());
  const auto sequence = open_sequence(directory.path());
  ASSERT_TRUE(sequence.ok()) << sequence.error().message;
  EXPECT_EQ((*sequence)->image_id(0), 5);
  EXPECT_EQ((*sequence)->image_id(1), 6) << "a number that does not ascend must be replaced by the next one";
  const auto read = (*sequence)->read_ground_truth(0);
  ASSERT_EQ(read->size(), 3U);
  EXPECT_EQ((*read)[0].bop_id, 4);
  EXPECT_EQ((*read)[1].bop_id, 2);
  EXPECT_EQ((*read)[1].object, "new");
  EXPECT_TRUE(std::isnan((*read)[1].visible_share));
  EXPECT_EQ((*read)[2].instance, 7);
}

TEST(BopModels, MeshSymmetriesAndIdsComeBack) {
  io::TestDirectory directory;
  std::vector<ModelSource> models(2);
  for (int i = 0; i < 2; ++i) {
    models[i].name = i == 0 ? "zebra" : "ant";
    models[i].bop_id = i == 0 ? 0 : 1;
    TriangleMesh mesh;
    mesh.vertices = {{0, 0, 0}, {0.1F, 0, 0}, {0, 0.2F, 0.1F}};
    mesh.faces = {{0, 1, 2}};
    mesh.uvs = {{0, 0}, {1, 0}, {0, 1}};
    mesh.texture = io::random_frame("t", i).color;
    compute_vertex_normals(mesh);
    models[i].mesh = mesh;
  }
  Rng rng(3);
  models[0].symmetries.discrete = {io::random_pose(rng)};
  models[0].symmetries.continuous = {{Eigen::Vector3d(0, 0.6, 0.8), Eigen::Vector3d(0.01, 0, 0)}};
  const auto ids = assign_bop_ids(std::vector<int>{models[0].bop_id, models[1].bop_id});
  ASSERT_TRUE(ids.ok());
  const auto writer = BopModelsWriter::create(directory / "set");
  ASSERT_TRUE(writer.ok());
  for (std::size_t i = 0; i < 2; ++i) ASSERT_TRUE((*writer)->write_model(models[i], (*ids)[i]).ok());
  ASSERT_TRUE((*writer)->finish().ok());
  const auto found = find_models({directory / "set"});
  ASSERT_TRUE(found.ok()) << found.error().message;
  ASSERT_EQ(found->size(), 2U);
  EXPECT_EQ((*found)[0].name, "ant");
  EXPECT_EQ((*found)[1].bop_id, 2);
  const auto zebra = read_model((*found)[1]);
  ASSERT_TRUE(zebra.ok()) << zebra.error().message;
  ASSERT_TRUE(zebra->mesh.has_value());
  EXPECT_EQ(zebra->mesh->texture, models[0].mesh->texture);
  for (int i = 0; i < 3; ++i) EXPECT_LT((zebra->mesh->vertices[i] - models[0].mesh->vertices[i]).norm(), 1e-7F);
  EXPECT_TRUE(zebra->symmetries_known);
  const auto ant = read_model((*found)[0]);
  ASSERT_TRUE(ant.ok()) << ant.error().message;
  EXPECT_TRUE(ant->symmetries_known && ant->symmetries.none()) << "declared without symmetries";
  ASSERT_EQ(zebra->symmetries.discrete.size(), 1U);
  EXPECT_LT(io::pose_difference(zebra->symmetries.discrete[0], models[0].symmetries.discrete[0]), 1e-12);
  ASSERT_EQ(zebra->symmetries.continuous.size(), 1U);
  EXPECT_LT((zebra->symmetries.continuous[0].direction - Eigen::Vector3d(0, 0.6, 0.8)).norm(), 1e-12);
  EXPECT_LT((zebra->symmetries.continuous[0].point - Eigen::Vector3d(0.01, 0, 0)).norm(), 1e-12);
  const auto info = nlohmann::json::parse(io::read_text(directory / "set/models/models_info.json"));
  EXPECT_NEAR(info["2"]["diameter"].get<double>(), 1000 * std::sqrt(0.06), 1e-3);
  EXPECT_NEAR(info["2"]["size_y"].get<double>(), 200, 1e-3);
  EXPECT_THAT(BopModelsWriter::create(directory / "set").error().message, HasSubstr("exists already"));
}

TEST(BopModels, IdsAreFilledUp) {
  EXPECT_THAT(*assign_bop_ids(std::vector<int>{0, 2, 0, 1, 0}), testing::ElementsAre(3, 2, 4, 1, 5));
  EXPECT_FALSE(assign_bop_ids(std::vector<int>{2, 2}).ok());
}

TEST(BopModels, NamesThatCannotBeUsed) {
  io::TestDirectory directory;
  io::write_text(directory / "models/obj_000001.ply", "");
  for (const std::string& name : {std::string(), std::string("../../x"), std::string(100000, 'a')}) {
    io::write_text(directory / "models/models_info.json", R"({"1": {"name": ")" + name + R"("}})");
    EXPECT_THAT(find_models({directory / "models"}).error().message,
                HasSubstr("models_info.json: object 1: the name of an object"));
  }
}

TEST(BopModels, MetresInAMillimetreFolder) {
  io::TestDirectory directory;
  io::write_text(
      directory / "models/obj_000001.ply",
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nelement face 1\n"
      "property list uchar int vertex_indices\nend_header\n0 0 0\n.1 0 0\n0 .2 0\n3 0 1 2\n");
  const auto found = find_models({directory / "models"});
  ASSERT_TRUE(found.ok());
  EXPECT_EQ(found->front().name, "obj_000001");
  EXPECT_THAT(read_model(found->front()).error().message, HasSubstr("looks like metres"));
  ModelLocation in_metres = found->front();
  in_metres.metres_per_unit = 1;
  const auto model = read_model(in_metres);
  ASSERT_TRUE(model.ok()) << model.error().message;
  EXPECT_FLOAT_EQ(model->mesh->vertices.at(2).y(), 0.2F);
}

}  // namespace
}  // namespace resight
