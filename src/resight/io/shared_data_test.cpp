// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <cctype>
#include <cmath>
#include <map>

#include "resight/io/internal/test_data.hpp"
#include "resight/io/model_source.hpp"
#include "resight/io/sequence.hpp"

/// Tests with real data from independent sources, if available.
namespace resight {
namespace {

using io::shared_data;
using testing::HasSubstr;

struct Expected {
  std::string directory;
  std::string format;
  int num_views;
  double min_valid;  ///< Share of pixels with depth.
};

class SharedSequence : public testing::TestWithParam<Expected> {};

TEST_P(SharedSequence, Opens) {
  const Expected& expected = GetParam();
  RESIGHT_NEEDS_DATA(expected.directory);
  const auto sequence = open_sequence(shared_data(expected.directory));
  ASSERT_TRUE(sequence.ok()) << sequence.error().message;
  EXPECT_EQ((*sequence)->format(), expected.format);
  ASSERT_EQ((*sequence)->num_views(), expected.num_views);
  for (const int view : {0, expected.num_views - 1}) {
    const auto frame = (*sequence)->read_view(view);
    ASSERT_TRUE(frame.ok()) << frame.error().message;
    EXPECT_EQ(frame->name, (*sequence)->view_name(view));
    const double valid = static_cast<double>(count_valid(frame->depth_m)) / static_cast<double>(frame->depth_m.size());
    EXPECT_GT(valid, expected.min_valid);
    EXPECT_LT(*std::ranges::max_element(frame->depth_m.data(), {}, [](float z) { return std::isnan(z) ? 0 : z; }), 20);
  }
}

INSTANTIATE_TEST_SUITE_P(
    All, SharedSequence,
    testing::Values(Expected{"table-rendered", "bop", 12, 0.7}, Expected{"table-rendered/test", "bop", 12, 0.7},
                    Expected{"table-rendered/test/000001", "bop", 12, 0.7}, Expected{"tum-fr1-xyz", "tum", 55, 0.5},
                    Expected{"table-two-states", "color-depth", 2, 0.5}, Expected{"hots-table", "npy", 20, 0.5},
                    Expected{"apc-bin", "cam-info", 15, 0.2}, Expected{"apc-bin/scene-0000", "cam-info", 15, 0.2},
                    Expected{"arc-bin-twocams", "numbered-cameras", 4, 0.3}, Expected{"pcl-milk", "tuw", 1, 0.3}),
    [](const auto& tested) {
      std::string name = tested.param.directory;
      std::ranges::replace_if(
          name, [](char c) { return !std::isalnum(static_cast<unsigned char>(c)); }, '_');
      return name;
    });

/// Share of the mesh vertices of an object that have a depth measurement within 2 cm, among those on valid pixels.
double agreement(const RgbdFrame& frame, const Rigid3& camera_from_object,
                 const std::vector<Eigen::Vector3f>& vertices) {
  int close = 0;
  int all = 0;
  for (const auto& vertex : vertices) {
    const Eigen::Vector3d p = camera_from_object * vertex.cast<double>();
    const Eigen::Vector2d pixel = frame.camera.project(p);
    if (p.z() <= 0 || !frame.camera.contains(pixel)) continue;
    const float z = frame.depth_m(static_cast<int>(pixel.x() + 0.5), static_cast<int>(pixel.y() + 0.5));
    if (std::isnan(z)) continue;
    ++all;
    close += std::abs(p.z() - z) < 0.02 ? 1 : 0;
  }
  return all < 100 ? 0 : static_cast<double>(close) / all;
}

void expect_truth_fits(const Sequence& sequence, const std::vector<ModelLocation>& models, int min_objects) {
  std::map<std::string, ModelSource> loaded;
  int num_checked = 0;
  for (int view = 0; view < sequence.num_views(); view += 6) {
    const auto frame = sequence.read_view(view);
    const auto truth = sequence.read_ground_truth(view);
    ASSERT_TRUE(frame.ok() && truth.ok());
    for (const GroundTruthObject& object : *truth) {
      const auto location = std::ranges::find(models, object.object, &ModelLocation::name);
      if (location == models.end() || object.visible_share < 0.5) continue;
      if (!loaded.contains(object.object)) {
        auto model = read_model(*location);
        ASSERT_TRUE(model.ok()) << model.error().message;
        ASSERT_TRUE(model->mesh.has_value());
        loaded[object.object] = std::move(*model);
      }
      // About half of the vertices are on the visible side.
      EXPECT_GT(agreement(*frame, object.camera_from_object, loaded[object.object].mesh->vertices), 0.15)
          << object.object << " in view " << view;
      ++num_checked;
    }
  }
  EXPECT_GE(num_checked, min_objects);
}

TEST(SharedData, BopTruthMeshesAndDepthAgree) {
  RESIGHT_NEEDS_DATA("table-rendered");
  const auto sequence = open_sequence(shared_data("table-rendered"));
  const auto models = find_models({shared_data("table-rendered")});
  ASSERT_TRUE(models.ok()) << models.error().message;
  ASSERT_EQ(models->size(), 8U);
  EXPECT_EQ(models->front().name, "003_cracker_box");
  expect_truth_fits(**sequence, *models, 15);
}

TEST(SharedData, PseudoTruthFitsTheScannedMeshes) {
  RESIGHT_NEEDS_DATA("table-two-states");
  RESIGHT_NEEDS_DATA("ycb-meshes");
  const auto sequence = open_sequence(shared_data("table-two-states"));
  const auto models = find_models({shared_data("ycb-meshes")});
  ASSERT_TRUE(models.ok()) << models.error().message;
  ASSERT_EQ(models->size(), 15U);
  ASSERT_TRUE((*sequence)->has_ground_truth());
  expect_truth_fits(**sequence, *models, 4);
}

TEST(SharedData, ShelfTruthIsInTheWorld) {
  RESIGHT_NEEDS_DATA("apc-bin");
  const auto sequence = open_sequence(shared_data("apc-bin"));
  ASSERT_TRUE((*sequence)->has_ground_truth());
  const auto truth = (*sequence)->read_ground_truth(7);
  ASSERT_TRUE(truth.ok());
  ASSERT_EQ(truth->size(), 3U);
  for (const auto& object : *truth) {
    EXPECT_GT(object.camera_from_object.translation.z(), 0.2);
    EXPECT_LT(object.camera_from_object.translation.z(), 1.0);
  }
}

TEST(SharedData, TheSameObjectAsPlyInMillimetresAndObjInMetres) {
  RESIGHT_NEEDS_DATA("table-rendered");
  RESIGHT_NEEDS_DATA("ycb-meshes");
  const auto bop = find_models({shared_data("table-rendered/models/obj_000005.ply")});
  ASSERT_TRUE(bop.ok());
  const auto as_metres = read_model(bop->front());  // a separate PLY is read in metres
  ASSERT_FALSE(as_metres.ok());
  EXPECT_THAT(as_metres.error().message, HasSubstr("looks like millimetres"));
  const auto all = find_models({shared_data("table-rendered/models")});
  ASSERT_TRUE(all.ok());
  const auto ply = read_model(*std::ranges::find(*all, "005_tomato_soup_can", &ModelLocation::name));
  const auto obj = read_model(find_models({shared_data("ycb-meshes/005_tomato_soup_can")})->front());
  ASSERT_TRUE(ply.ok() && obj.ok());
  EXPECT_EQ(obj->name, "005_tomato_soup_can");
  EXPECT_TRUE(obj->warnings.empty());
  ASSERT_TRUE(ply->mesh->has_texture());
  ASSERT_TRUE(obj->mesh->has_texture());
  ASSERT_EQ(ply->mesh->faces.size(), obj->mesh->faces.size());
  EXPECT_NEAR(diameter(ply->mesh->vertices), diameter(obj->mesh->vertices), 1e-5);
  // The same corner must have the same position in space and in the texture, and the texture must not be upside down
  // relative to the other reader.
  for (std::size_t f = 0; f < ply->mesh->faces.size(); f += 97)
    for (int k = 0; k < 3; ++k) {
      const int a = ply->mesh->faces[f][k];
      const int b = obj->mesh->faces[f][k];
      EXPECT_LT((ply->mesh->vertices[a] - obj->mesh->vertices[b]).norm(), 1e-5F);
      EXPECT_LT((ply->mesh->uvs[a] - obj->mesh->uvs[b]).norm(), 1e-5F);
    }
}

TEST(SharedData, MilkCartonIsOneView) {
  RESIGHT_NEEDS_DATA("pcl-milk");
  const auto models = find_models({shared_data("pcl-milk")});
  ASSERT_TRUE(models.ok()) << models.error().message;
  ASSERT_EQ(models->size(), 1U);
  EXPECT_EQ(models->front().name, "milk");
  EXPECT_EQ(models->front().format, "cloud");
  const auto model = read_model(models->front());
  ASSERT_TRUE(model.ok()) << model.error().message;
  ASSERT_EQ(model->views.size(), 1U);
  // 12,575 points of another capture. Most have a pixel of their own.
  EXPECT_GT(count_valid(model->views[0].frame.depth_m), 10500U);
  EXPECT_LT((model->views[0].frame.world_from_camera * Eigen::Vector3d::UnitZ()).z(), 0)
      << "the cloud has its z axis backward";
  EXPECT_TRUE(check_frame(model->views[0].frame).ok());
}

TEST(SharedData, RealKinectCloudHasAPinholeCamera) {
  RESIGHT_NEEDS_DATA("pcl-milk");
  const auto sequence = open_sequence(shared_data("pcl-milk"));
  const auto frame = (*sequence)->read_view(0);
  ASSERT_TRUE(frame.ok()) << frame.error().message;
  EXPECT_GT(count_valid(frame->depth_m), 240000U);
  EXPECT_NEAR(frame->camera.fx, 525, 1e-3);
  EXPECT_NEAR(frame->camera.fy, 525, 1e-3);
  EXPECT_NEAR(frame->camera.cx, 319.5, 1e-3);
  EXPECT_NEAR(frame->camera.cy, 239.5, 1e-3);
}

TEST(SharedData, ShelfModelsPreferTheMeshOverItsConversions) {
  RESIGHT_NEEDS_DATA("apc-bin");
  const auto models = find_models({shared_data("apc-bin/models/rutgers")});
  ASSERT_TRUE(models.ok()) << models.error().message;
  ASSERT_EQ(models->size(), 2U);
  for (const auto& location : *models) {
    EXPECT_EQ(location.path.extension(), ".obj");
    const auto model = read_model(location);
    ASSERT_TRUE(model.ok()) << model.error().message;
    EXPECT_TRUE(model->mesh.has_value());
  }
  // The second texture is missing. This must give a warning, not silent grey.
  EXPECT_TRUE(read_model(models->front())->mesh->has_texture());
  EXPECT_EQ(read_model(models->back())->warnings.size(), 1U);
}

TEST(SharedData, TumPosesAreInterpolated) {
  RESIGHT_NEEDS_DATA("tum-fr1-xyz");
  const auto sequence = open_sequence(shared_data("tum-fr1-xyz"));
  ASSERT_TRUE(sequence.ok());
  EXPECT_TRUE((*sequence)->has_poses());
  const auto first = (*sequence)->read_view(0);
  const auto last = (*sequence)->read_view(54);
  ASSERT_TRUE(first.ok() && last.ok());
  EXPECT_NEAR(first->camera.fx, 517.3, 1e-9);
  // Depth at ..02.763549, between poses at ..02.7559 (x = 1.1986) and ..02.7659 (x = 1.1962).
  EXPECT_NEAR(first->world_from_camera.translation.x(), 1.19676, 1e-5);
  EXPECT_GT((first->world_from_camera.translation - last->world_from_camera.translation).norm(), 1e-3);
}

}  // namespace
}  // namespace resight
