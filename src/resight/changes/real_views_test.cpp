// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <string>

#include "resight/changes/change_detector.hpp"
#include "resight/changes/difference.hpp"
#include "resight/io/images.hpp"
#include "resight/io/mesh.hpp"

namespace resight {
namespace {

using ChangeTest = decltype(DetectChangesOptions::test);

const std::filesystem::path kFolder = std::filesystem::path(RESIGHT_SHARED_DATA_DIR) / "table-two-states";
const std::filesystem::path kMeshFolder = std::filesystem::path(RESIGHT_SHARED_DATA_DIR) / "ycb-meshes";

/// Two views of one fixed camera, all objects exchanged between them.
class TableTwoStates : public testing::Test {
 protected:
  void SetUp() override {
    for (const auto& folder : {kFolder, kMeshFolder})
      if (!std::filesystem::exists(folder)) GTEST_SKIP() << folder << " is absent";
    before = load("000000");
    after = load("000001");
    std::ifstream file(kFolder / "derived" / "pseudo_gt.json");
    truth = nlohmann::json::parse(file)["frames"];
    previous = to_point_cloud(before.cloud, &before.frame.color, false);
  }

  static PreparedView load(const std::string& name) {
    const Camera camera{640, 480, 618.0173, 618.0033, 312.377, 232.3753};
    return prepare_view({name, camera, read_color(kFolder / (name + "-color.png")).value(),
                         read_depth(kFolder / (name + "-depth.png"), 0.001).value(), Rigid3::identity()});
  }

  /// Surfaces of the annotated objects of a view, camera frame (= world).
  [[nodiscard]] std::vector<ProximityGrid> surfaces(const std::string& view) const {
    std::vector<ProximityGrid> grids;
    for (const auto& object : truth.at(view)) {
      Eigen::Matrix4d pose;
      for (int row = 0; row < 4; ++row)
        for (int column = 0; column < 4; ++column)
          pose(row, column) = object.at("camera_from_object")[row][column].get<double>();
      const std::string name = object.at("object").get<std::string>();
      PointCloud vertices;  // 16,000 faces: a few millimetres apart
      vertices.points = read_mesh(kMeshFolder / name / "textured.obj").value().mesh.vertices;
      grids.emplace_back(transform(Rigid3::from_matrix(pose), vertices).points, 0.015);
    }
    return grids;
  }

  PreparedView before;
  PreparedView after;
  PointCloud previous;
  nlohmann::json truth;
};
/// The points on the table: the floor behind it is 2.5 m away and noisy.
PointCloud on_table(const PointCloud& cloud) {
  PointCloud result;
  std::ranges::copy_if(cloud.points, std::back_inserter(result.points), [](const auto& p) { return p.z() < 1.4F; });
  return result;
}

/// Points on each of the surfaces, and at the end those on none.
std::vector<int> count_on(const PointCloud& cloud, const std::vector<ProximityGrid>& surfaces) {
  std::vector<int> counts(surfaces.size() + 1);
  for (const Eigen::Vector3f& p : cloud.points) {
    const auto found = std::ranges::find_if(surfaces, [&](const auto& s) { return s.any_within(p); });
    ++counts[static_cast<std::size_t>(found - surfaces.begin())];
  }
  return counts;
}

TEST_F(TableTwoStates, EveryObjectIsRemovedAndEveryOtherOneNovel) {
  const std::vector<ProximityGrid> old_objects = surfaces("000000");
  const std::vector<ProximityGrid> new_objects = surfaces("000001");
  ASSERT_EQ(old_objects.size(), 4U);
  ASSERT_EQ(new_objects.size(), 5U);
  const PreparedView* earlier[] = {&before};
  for (const ChangeTest& test :
       {ChangeTest(PointTestOptions{.frustum_margin_rad = 0}), ChangeTest(DepthTestOptions{})}) {
    const ChangeResult changes = detect_changes(previous, after, {.test = test}, earlier);
    EXPECT_FALSE(changes.pose_suspect);
    const PointCloud removed = on_table(changes.removed_in_world);
    const PointCloud novel = on_table(changes.novel_in_world);
    const std::vector<int> removed_counts = count_on(removed, old_objects);
    const std::vector<int> novel_counts = count_on(novel, new_objects);
    for (std::size_t i = 0; i < 4; ++i) EXPECT_GT(removed_counts[i], 300) << "object " << i;
    for (std::size_t i = 0; i < 5; ++i) EXPECT_GT(novel_counts[i], 100) << "object " << i;
    // The rest is the foam brick, which has no annotation, and noise.
    EXPECT_LT(removed_counts[4], 0.15 * static_cast<double>(removed.size()));
    EXPECT_LT(novel_counts[5], 0.05 * static_cast<double>(novel.size()));
  }
}

TEST_F(TableTwoStates, TheTableStaysForwardsAndBackwards) {
  for (const ChangeTest& test : {ChangeTest(PointTestOptions{}), ChangeTest(DepthTestOptions{})}) {
    for (const bool forward : {true, false}) {
      const PreparedView& first = forward ? before : after;
      const PreparedView& second = forward ? after : before;
      const PointCloud first_cloud = to_point_cloud(first.cloud, &first.frame.color, false);
      const PreparedView* earlier[] = {&first};
      const ChangeResult changes = detect_changes(first_cloud, second, {.test = test}, earlier);
      EXPECT_GT(changes.evidence_count[static_cast<std::size_t>(Evidence::kPresent)], 20000);
      EXPECT_GT(changes.changed_share, 0.005);
      EXPECT_LT(changes.changed_share, 0.3);
    }
  }
}

}  // namespace
}  // namespace resight
