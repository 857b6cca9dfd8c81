// SPDX-License-Identifier: Apache-2.0
#include "resight/io/convert.hpp"

#include <gmock/gmock.h>

#include <cmath>

#include "resight/io/images.hpp"
#include "resight/io/internal/test_data.hpp"
#include "resight/io/tuw_models.hpp"

namespace resight {
namespace {

using testing::HasSubstr;

/// Writes views 0, 2, 4, ... with two objects each in `format`.
void write_sequence(const std::filesystem::path& directory, DatasetFormat format) {
  const auto writer = create_sequence(directory, format);
  ASSERT_TRUE(writer.ok());
  Rng rng(5);
  for (int i = 0; i < 4; ++i) {
    const std::vector<GroundTruthObject> truth = {{"mug", 0, 0, io::random_pose(rng), 0.5},
                                                  {"red_box", 0, 0, io::random_pose(rng), 0.125 * i}};
    ASSERT_TRUE((*writer)->write_view(io::random_frame("cloud_" + std::to_string(2 * i), i), truth).ok());
  }
  ASSERT_TRUE((*writer)->finish().ok());
}

/// `depth_tolerance_m` is the largest acceptable rounding error.
void expect_same(const Sequence& a, const Sequence& b, double depth_tolerance_m) {
  ASSERT_EQ(a.num_views(), 4);
  ASSERT_EQ(b.num_views(), 4);
  for (int i = 0; i < 4; ++i) {
    const auto x = a.read_view(i);
    const auto y = b.read_view(i);
    ASSERT_TRUE(x.ok() && y.ok());
    EXPECT_EQ(x->camera, y->camera);
    EXPECT_EQ(x->color, y->color);
    EXPECT_LE(io::depth_difference_m(x->depth_m, y->depth_m), depth_tolerance_m);
    EXPECT_LT(io::pose_difference(x->world_from_camera, y->world_from_camera), 1e-12);
    const auto s = a.read_ground_truth(i);
    const auto t = b.read_ground_truth(i);
    ASSERT_TRUE(s.ok() && t.ok());
    ASSERT_EQ(s->size(), 2U);
    ASSERT_EQ(t->size(), 2U);
    for (int k = 0; k < 2; ++k) {
      EXPECT_EQ((*s)[k].object, (*t)[k].object);
      EXPECT_EQ((*s)[k].instance, (*t)[k].instance);
      EXPECT_NEAR((*s)[k].visible_share, (*t)[k].visible_share, 1e-15);
      EXPECT_LT(io::pose_difference((*s)[k].camera_from_object, (*t)[k].camera_from_object), 1e-12);
    }
  }
}

class SequenceRoundTrip : public testing::TestWithParam<DatasetFormat> {};

TEST_P(SequenceRoundTrip, ThereAndBack) {
  io::TestDirectory directory;
  const DatasetFormat own = GetParam();
  const DatasetFormat other = own == DatasetFormat::kTuw ? DatasetFormat::kBop : DatasetFormat::kTuw;
  write_sequence(directory / "a", own);
  const auto a = open_sequence(directory / "a");
  ASSERT_TRUE(a.ok()) << a.error().message;
  const auto there = convert_sequence(**a, directory / "b", other);
  ASSERT_TRUE(there.ok()) << there.error().message;
  EXPECT_EQ(there->num_views, 4);
  EXPECT_EQ(there->num_objects, 8);
  const auto b = open_sequence(directory / "b");
  ASSERT_TRUE(b.ok()) << b.error().message;
  EXPECT_NE((*a)->format(), (*b)->format());
  ASSERT_TRUE(convert_sequence(**b, directory / "c", own).ok());
  const auto c = open_sequence(directory / "c");
  ASSERT_TRUE(c.ok()) << c.error().message;
  EXPECT_EQ((*a)->format(), (*c)->format());
  // Depths are multiples of 0.1 mm, which BOP preserves; only float rounding remains.
  expect_same(**a, **b, 1e-7);
  expect_same(**a, **c, 1e-7);
  EXPECT_EQ((*a)->image_id(3), (*c)->image_id(3));
}

INSTANTIATE_TEST_SUITE_P(Formats, SequenceRoundTrip, testing::Values(DatasetFormat::kTuw, DatasetFormat::kBop));

TEST(ConvertSequence, WhatIsUnknownIsLeftOut) {
  io::TestDirectory directory;
  for (const char* name : {"1", "2"}) {
    const RgbdFrame frame = io::random_frame("0", 1);
    ASSERT_TRUE(write_color(directory / "in" / "rgb" / (std::string(name) + ".png"), frame.color).ok());
    ASSERT_TRUE(write_depth(directory / "in" / "depth" / (std::string(name) + ".png"), frame.depth_m, 0.001).ok());
  }
  io::write_text(directory / "in" / "intrinsics.txt", "50 50 23.5 17.5\n");
  const auto views = open_sequence(directory / "in");
  ASSERT_TRUE(views.ok()) << views.error().message;
  ASSERT_TRUE(convert_sequence(**views, directory / "bop", DatasetFormat::kBop).ok());
  const auto bop = open_sequence(directory / "bop");
  ASSERT_TRUE(bop.ok()) << bop.error().message;
  EXPECT_FALSE((*bop)->has_poses());
  EXPECT_FALSE((*bop)->has_ground_truth());
  const auto tuw = convert_sequence(**views, directory / "tuw", DatasetFormat::kTuw);
  ASSERT_FALSE(tuw.ok());
  EXPECT_THAT(tuw.error().message, HasSubstr("no camera poses"));
  EXPECT_FALSE(std::filesystem::exists(directory / "tuw"));
  OpenSequenceOptions fixed;
  fixed.poses = "fixed";
  EXPECT_TRUE(convert_sequence(**open_sequence(directory / "in", fixed), directory / "tuw", DatasetFormat::kTuw).ok());
}

TEST(ConvertSequence, ScenesOfOneDataSetShareTheIdsOfTheirObjects) {
  io::TestDirectory directory;
  const auto write = [&](const std::string& scene, const std::vector<std::pair<std::string, int>>& objects) {
    std::vector<GroundTruthObject> truth;
    for (const auto& [name, id] : objects) truth.push_back({name, id, 0, Rigid3(), std::nan("")});
    const auto writer = create_sequence(directory / scene, DatasetFormat::kBop);
    if (!writer) return writer.error().message;
    if (const auto done = (*writer)->write_view(io::random_frame("0", 1), truth); !done) return done.error().message;
    const auto done = (*writer)->finish();
    return done.ok() ? std::string() : done.error().message;
  };
  const auto ids = [&](const std::string& scene) {
    std::vector<int> found;
    const auto truth = (*open_sequence(directory / scene))->read_ground_truth(0);
    for (const GroundTruthObject& object : *truth) found.push_back(object.bop_id);
    return found;
  };
  EXPECT_EQ(write("test/000001", {{"mug", 0}, {"obj_000007", 7}}), "");
  EXPECT_EQ(write("test/000002", {{"bowl", 0}, {"mug", 0}, {"fork", 0}}), "");
  EXPECT_EQ(ids("test/000002"), (std::vector<int>{2, 1, 3}));
  EXPECT_EQ(write("test/000003", {{"cup", 0}, {"bowl", 0}, {"obj_000007", 0}}), "");
  EXPECT_EQ(ids("test/000003"), (std::vector<int>{4, 2, 7}));
  EXPECT_THAT(write("test/000004", {{"mug", 5}}), HasSubstr("object 'mug' has the ids 1 and 5"));
  // Folders that are no numbers are no scenes of a data set.
  EXPECT_EQ(write("test/other", {{"bowl", 0}}), "");
  EXPECT_EQ(ids("test/other"), std::vector<int>{1});
  io::write_text(directory / "test/000002/scene_gt.json", "{");
  EXPECT_THAT(write("test/000004", {{"mug", 0}}), HasSubstr("000002/scene_gt.json"));
}

// Other readers of BOP expect numbers in scene_gt_info.json.
TEST(ConvertSequence, UnknownVisibilityIsNotWrittenAsAnEmptyEntry) {
  io::TestDirectory directory;
  const auto write = [&](const std::string& scene, double first_share) {
    const auto writer = create_sequence(directory / scene, DatasetFormat::kBop);
    ASSERT_TRUE(writer.ok());
    const std::vector<GroundTruthObject> truth = {{"mug", 0, 0, Rigid3(), first_share},
                                                  {"bowl", 0, 0, Rigid3(), std::nan("")}};
    ASSERT_TRUE((*writer)->write_view(io::random_frame("0", 1), truth).ok());
    ASSERT_TRUE((*writer)->finish().ok());
  };
  write("a", std::nan(""));
  EXPECT_FALSE(std::filesystem::exists(directory / "a" / "scene_gt_info.json"));
  write("b", 0.5);
  EXPECT_THAT(io::read_text(directory / "b" / "scene_gt_info.json"), HasSubstr("-1"));
  const auto truth = (*open_sequence(directory / "b"))->read_ground_truth(0);
  EXPECT_EQ((*truth)[0].visible_share, 0.5);
  EXPECT_TRUE(std::isnan((*truth)[1].visible_share));
}

TEST(ConvertSequence, DepthIsRoundedToTenthsOfMillimetres) {
  io::TestDirectory directory;
  RgbdFrame frame = io::random_frame("0", 1);
  for (std::size_t i = 0; i < frame.depth_m.size(); ++i) frame.depth_m[i] += 3.3e-5F;
  const auto writer = create_sequence(directory / "a", DatasetFormat::kBop);
  ASSERT_TRUE((*writer)->write_view(frame, {}).ok() && (*writer)->finish().ok());
  const auto read = (*open_sequence(directory / "a"))->read_view(0);
  ASSERT_TRUE(read.ok());
  const double lost_m = io::depth_difference_m(read->depth_m, frame.depth_m);
  EXPECT_GT(lost_m, 3e-5);
  EXPECT_LT(lost_m, 5.1e-5);
}

TEST(ConvertSequence, FarDepthsTakeWholeMillimetres) {
  io::TestDirectory directory;
  RgbdFrame frame = io::random_frame("0", 1);
  frame.depth_m(3, 3) = 20.5F;
  const auto writer = create_sequence(directory / "a", DatasetFormat::kBop);
  ASSERT_TRUE((*writer)->write_view(frame, {}).ok() && (*writer)->finish().ok());
  EXPECT_LT(io::depth_difference_m((*open_sequence(directory / "a"))->read_view(0)->depth_m, frame.depth_m), 5.1e-4);
}

TEST(ConvertSequence, NothingRemainsOfAFailure) {
  io::TestDirectory directory;
  write_sequence(directory / "in/a", DatasetFormat::kTuw);
  io::write_text(directory / "in/a/cloud_6.pcd", "DATA binary\n");
  std::filesystem::create_directories(directory / "out");
  const auto sequence = open_sequence(directory / "in/a");
  if (sequence.ok()) {
    EXPECT_FALSE(convert_sequence(**sequence, directory / "out/b", DatasetFormat::kBop).ok());
  }
  EXPECT_TRUE(std::filesystem::is_empty(directory / "out"));
}

void expect_same_models(const ModelSource& a, const ModelSource& b) {
  EXPECT_EQ(a.name, b.name);
  EXPECT_EQ(a.bop_id, b.bop_id);
  ASSERT_EQ(a.views.size(), 3U);
  ASSERT_EQ(b.views.size(), 3U);
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(a.views[i].mask, b.views[i].mask);
    EXPECT_EQ(a.views[i].frame.color, b.views[i].frame.color);
    EXPECT_EQ(a.views[i].frame.camera, b.views[i].frame.camera);
    EXPECT_LE(io::depth_difference_m(a.views[i].frame.depth_m, b.views[i].frame.depth_m), 1e-7);
    EXPECT_LT(io::pose_difference(a.views[i].frame.world_from_camera, b.views[i].frame.world_from_camera), 1e-12);
  }
  ASSERT_EQ(a.symmetries.discrete.size(), 1U);
  ASSERT_EQ(b.symmetries.discrete.size(), 1U);
  EXPECT_LT(io::pose_difference(a.symmetries.discrete[0], b.symmetries.discrete[0]), 1e-12);
  ASSERT_EQ(a.surface.has_value(), b.surface.has_value());
  if (!a.surface) return;
  ASSERT_EQ(a.surface->size(), b.surface->size());
  EXPECT_EQ(a.surface->colors, b.surface->colors);
  for (std::size_t i = 0; i < a.surface->size(); ++i)
    EXPECT_LT((a.surface->points[i] - b.surface->points[i]).norm(), 1e-7F);
}

class ModelRoundTrip : public testing::TestWithParam<bool> {};

TEST_P(ModelRoundTrip, ViewsThereAndBack) {
  io::TestDirectory directory;
  std::vector<TrainingView> views;
  for (int i = 0; i < 3; ++i) views.push_back(io::random_training_view("cloud_" + std::to_string(3 * i), 10 + i));
  PointCloud surface;
  surface.points = {{0, 0, 0}, {0.1F, 0, 0}, {0, 0.1F, 0.05F}};
  surface.colors = {{1, 2, 3}, {4, 5, 6}, {7, 8, 9}};
  ObjectSymmetries symmetries;
  symmetries.discrete.push_back(Rigid3::from_axis_angle({0, 0, 1}, 3.141592653589793));
  const bool with_surface = GetParam();
  ASSERT_TRUE(write_tuw_model(directory / "tuw", "mug", views, with_surface ? &surface : nullptr, symmetries, 6).ok());
  ASSERT_TRUE(write_tuw_model(directory / "tuw", "box", views, with_surface ? &surface : nullptr, symmetries).ok());
  const auto tuw = find_models({directory / "tuw"});
  ASSERT_TRUE(tuw.ok()) << tuw.error().message;
  const auto to_bop = convert_models(*tuw, directory / "bop", DatasetFormat::kBop);
  ASSERT_TRUE(to_bop.ok()) << to_bop.error().message;
  EXPECT_EQ(to_bop->num_objects, 2);
  EXPECT_EQ(to_bop->num_views, 6);
  const auto bop = find_models({directory / "bop"});
  ASSERT_TRUE(bop.ok()) << bop.error().message;
  ASSERT_TRUE(convert_models(*bop, directory / "tuw2", DatasetFormat::kTuw).ok());
  const auto tuw2 = find_models({directory / "tuw2"});
  ASSERT_TRUE(tuw2.ok()) << tuw2.error().message;
  ASSERT_TRUE(convert_models(*tuw2, directory / "bop2", DatasetFormat::kBop).ok());
  const auto bop2 = find_models({directory / "bop2"});
  ASSERT_EQ(bop->size(), 2U);
  ASSERT_EQ(tuw2->size(), 2U);
  for (int i = 0; i < 2; ++i) {
    auto original = read_model((*tuw)[i]);
    const auto b = read_model((*bop)[i]);
    const auto t = read_model((*tuw2)[i]);
    const auto b2 = read_model((*bop2)[i]);
    ASSERT_TRUE(original.ok() && b.ok() && t.ok() && b2.ok());
    if (original->bop_id == 0) original->bop_id = 1;  // a BOP model needs an id
    expect_same_models(*original, *b);
    expect_same_models(*original, *t);
    expect_same_models(*original, *b2);
    EXPECT_EQ(original->views[2].frame.name, t->views[2].frame.name);
  }
  // The training split alone is also sufficient.
  const auto split = find_models({directory / "bop/train"});
  ASSERT_TRUE(split.ok()) << split.error().message;
  ASSERT_EQ(split->size(), 2U);
  EXPECT_EQ(read_model(split->front())->views.size(), 3U);
}

INSTANTIATE_TEST_SUITE_P(Surface, ModelRoundTrip, testing::Bool());

TEST(ConvertModels, MeshesToBopOnly) {
  io::TestDirectory directory;
  io::write_text(directory / "in/box.obj", "v 0 0 0\nv 0.1 0 0\nv 0 0.2 0\nf 1 2 3\n");
  const auto found = find_models({directory / "in"});
  ASSERT_TRUE(found.ok());
  EXPECT_THAT(convert_models(*found, directory / "tuw", DatasetFormat::kTuw).error().message,
              HasSubstr("without views"));
  EXPECT_FALSE(std::filesystem::exists(directory / "tuw"));
  io::write_text(directory / "full/mine.txt", "mine");
  EXPECT_THAT(convert_models(*found, directory / "full", DatasetFormat::kBop).error().message,
              HasSubstr("exists already"));
  io::write_text(directory / ".bop.resight-partial/models/obj_000001.ply", "cut o");  // of an interrupted run
  ASSERT_TRUE(convert_models(*found, directory / "bop", DatasetFormat::kBop).ok());
  const auto bop = find_models({directory / "bop"});
  ASSERT_TRUE(bop.ok());
  EXPECT_EQ(bop->front().name, "box");
  EXPECT_NEAR(diameter(read_model(bop->front())->mesh->vertices), std::sqrt(0.05F), 1e-6F);
}

}  // namespace
}  // namespace resight
