// SPDX-License-Identifier: Apache-2.0
#include "resight/annotation/change_proposals.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "resight/annotation/annotated_inputs.hpp"
#include "resight/annotation/annotated_scene_test.hpp"
#include "resight/annotation/object_masks.hpp"
#include "resight/annotation/proposals_file.hpp"
#include "resight/core/input_file.hpp"

namespace resight {
namespace {

namespace fs = std::filesystem;

std::vector<ChangeProposal> propose(const Sequence& sequence, const DynamicSceneOptions& options = {}) {
  return propose_changes(sequence, options, 30).value();
}

/// Share of the pixels of a region that lie in the silhouette of an annotated object.
double share_in(const PixelRuns& pixels, const Image<std::uint8_t>& silhouette) {
  int num_pixels = 0;
  int num_inside = 0;
  for (const PixelRun& run : pixels) {
    for (int i = run.first; i < run.first + run.count; ++i, ++num_pixels)
      num_inside += silhouette[static_cast<std::size_t>(i)] != 0 ? 1 : 0;
  }
  return num_pixels == 0 ? NAN : static_cast<double>(num_inside) / num_pixels;
}

class ChangeProposals : public testing::Test {
 protected:
  ChangeProposals() : folder_(fs::temp_directory_path() / ("resight_proposals_" + std::to_string(::getpid()))) {
    fs::create_directories(folder_);
  }
  ~ChangeProposals() override { fs::remove_all(folder_); }
  test::AnnotatedScene scene_;
  fs::path folder_;
};

TEST_F(ChangeProposals, ShowTheThingThatCame) {
  const auto proposals = propose(scene_);
  const auto came = std::ranges::find_if(
      proposals, [](const ChangeProposal& p) { return p.view == 3 && p.kind == RegionKind::kNovel; });
  ASSERT_NE(came, proposals.end());
  std::vector<AnnotatedObject> moved;
  for (const auto& [id, object] : scene_.document.objects)
    if (object.first_view == 3) moved.push_back(object);
  ASSERT_EQ(moved.size(), 1U);
  ObjectMaskRenderer renderer(scene_.library);
  const auto masks = renderer.render(moved, scene_.frames[3]);
  ASSERT_EQ(masks.size(), 1U);
  EXPECT_GT(share_in(came->pixels, masks[0].whole), 0.9);
}

TEST_F(ChangeProposals, PixelsAreThoseOfTheRecordedImage) {
  DynamicSceneOptions options;
  options.prepare.max_pixels = 320 * 240 / 4;  // the work is done on half the width and height
  const auto whole = propose(scene_);
  const auto reduced = propose(scene_, options);
  const auto count = [](const std::vector<ChangeProposal>& proposals) {
    int num_pixels = 0;
    for (const ChangeProposal& p : proposals)
      for (const PixelRun& run : p.pixels) num_pixels += run.count;
    return num_pixels;
  };
  ASSERT_FALSE(reduced.empty());
  EXPECT_GT(count(reduced), count(whole) / 2) << "a quarter, if pixels of the reduced image were taken";
}

TEST_F(ChangeProposals, AreReadBackToTheBit) {
  const auto proposals = propose(scene_);
  ASSERT_GE(proposals.size(), 2U);
  ASSERT_TRUE(write_proposals(folder_ / "proposals.json", "a", proposals).ok());
  const auto read = read_proposals(folder_ / "proposals.json", "a", scene_.num_views());
  ASSERT_TRUE(read.has_value());
  ASSERT_EQ(read->size(), proposals.size());
  for (std::size_t p = 0; p < proposals.size(); ++p) {
    EXPECT_EQ((*read)[p].view, proposals[p].view);
    EXPECT_EQ((*read)[p].kind, proposals[p].kind);
    EXPECT_EQ((*read)[p].num_points, proposals[p].num_points);
    EXPECT_EQ((*read)[p].points_in_world, proposals[p].points_in_world);
    EXPECT_EQ((*read)[p].box.world_from_box.matrix(), proposals[p].box.world_from_box.matrix());
    EXPECT_EQ((*read)[p].box.size_m, proposals[p].box.size_m);
    EXPECT_EQ((*read)[p].pixels, proposals[p].pixels);
  }
}

TEST_F(ChangeProposals, AreFoundAgainWhereTheFileDoesNotFit) {
  const fs::path file = folder_ / "proposals.json";
  EXPECT_FALSE(read_proposals(file, "a", 6).has_value()) << "missing";
  ASSERT_TRUE(write_proposals(file, "a", propose(scene_)).ok());
  EXPECT_TRUE(read_proposals(file, "a", 6).has_value());
  EXPECT_FALSE(read_proposals(file, "b", 6).has_value()) << "of other inputs";
  EXPECT_FALSE(read_proposals(file, "a", 3).has_value()) << "of more views";
  const std::string text = *read_file(file);
  for (const std::string& damaged : {text.substr(0, text.size() / 2), std::string("[]"), std::string("{}"),
                                     std::string(text).replace(text.find("\"pixels\":["), 11, "\"pixels\":[7,")}) {
    std::ofstream(file) << damaged;
    EXPECT_FALSE(read_proposals(file, "a", 6).has_value()) << damaged.substr(0, 40);
  }
}

TEST_F(ChangeProposals, NestingDoesNotOverflowTheStack) {
  const fs::path file = folder_ / "proposals.json";
  ASSERT_TRUE(write_proposals(file, "a", propose(scene_)).ok());
  std::string text = *read_file(file);
  const std::string key = "\"view\":";
  constexpr std::size_t kDepth = 1000000;
  text.insert(text.find(key) + key.size(), std::string(kDepth, '[') + std::string(kDepth, ']') + ",\"v\":");
  std::ofstream(file) << text;
  EXPECT_FALSE(read_proposals(file, "a", 6).has_value());
}

TEST_F(ChangeProposals, TheDigestTellsInputsApart) {
  const std::string digest = *digest_inputs(scene_, "settings");
  EXPECT_EQ(*digest_inputs(scene_, "settings"), digest);
  EXPECT_NE(*digest_inputs(scene_, "other settings"), digest);
  float& depth_m = scene_.frames[2].depth_m(10, 10);
  const float old_m = std::exchange(depth_m, 0.5F);
  EXPECT_NE(*digest_inputs(scene_, "settings"), digest) << "one pixel";
  depth_m = old_m;
  scene_.frames[5].world_from_camera.translation.x() += 1e-6;
  EXPECT_NE(*digest_inputs(scene_, "settings"), digest) << "a pose";
}

TEST_F(ChangeProposals, AProjectBelongsToRotationsAndPixels) {
  const auto identify = [&] { return identify_inputs(scene_, scene_.library)->digest; };
  const std::string digest = identify();
  const std::string earlier = identify_inputs(scene_, scene_.library)->earlier_digest;
  scene_.frames[2].depth_m(10, 10) += 1e-6F;
  scene_.frames[3].world_from_camera.translation.x() += 1e-8;
  EXPECT_EQ(identify(), digest) << "rounding";
  RgbdFrame& frame = scene_.frames[2];
  frame.color(10, 10).r ^= 1;
  EXPECT_NE(identify(), digest) << "one pixel";
  frame.color(10, 10).r ^= 1;
  EXPECT_EQ(identify(), digest);
  frame.world_from_camera.rotation *= Eigen::AngleAxisd(0.001, Eigen::Vector3d::UnitX()).toRotationMatrix();
  EXPECT_NE(identify(), digest) << "a rotation";
  EXPECT_EQ(identify_inputs(scene_, scene_.library)->earlier_digest, earlier) << "neither counted before";
}

}  // namespace
}  // namespace resight
