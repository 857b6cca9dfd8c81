// SPDX-License-Identifier: Apache-2.0
#include "resight/annotation/export_annotation.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "resight/annotation/annotated_scene_test.hpp"
#include "resight/annotation/annotation_checks.hpp"
#include "resight/annotation/object_masks.hpp"
#include "resight/core/input_file.hpp"
#include "resight/evaluation/change_truth.hpp"
#include "resight/io/change_files.hpp"
#include "resight/io/images.hpp"
#include "resight/io/sequence.hpp"

namespace resight {
namespace {

namespace fs = std::filesystem;

class ExportAnnotationTest : public testing::Test {
 protected:
  ExportAnnotationTest() {
    char name[] = "/tmp/resight_export_XXXXXX";
    folder_ = ::mkdtemp(name);
  }
  ~ExportAnnotationTest() override { fs::remove_all(folder_); }
  void write() {
    ViewStore views(scene_);
    const auto summary =
        export_annotation(scene_->document, scene_->library, proposals_, views, "small", folder_ / "export");
    ASSERT_TRUE(summary.ok()) << summary.error().message;
  }
  std::shared_ptr<test::AnnotatedScene> scene_ = std::make_shared<test::AnnotatedScene>();
  std::vector<ChangeProposal> proposals_;
  fs::path folder_;
};

TEST_F(ExportAnnotationTest, TheEvaluationReadsTheExactTruth) {
  write();
  const fs::path bop = folder_ / "export" / "bop" / "small";
  const auto sequence = open_sequence(bop);
  ASSERT_TRUE(sequence.ok()) << sequence.error().message;
  const auto truth = read_sequence_truth(**sequence, scene_->library, find_change_files(bop, view_names(**sequence)));
  ASSERT_TRUE(truth.ok()) << truth.error().message;
  ASSERT_TRUE(truth->changes);
  ASSERT_EQ(truth->changes->size(), 2U);
  EXPECT_EQ((*truth->changes)[0].kind, ObjectEventKind::kMoved);
  EXPECT_EQ((*truth->changes)[0].view, 3);
  EXPECT_EQ((*truth->changes)[1].kind, ObjectEventKind::kRemoved);
  EXPECT_EQ((*truth->changes)[1].object, "tea_box");
  for (int v = 0; v < 6; ++v) {
    const auto read = *(*sequence)->read_ground_truth(v);
    const auto& exact = scene_->truth[static_cast<std::size_t>(v)];
    ASSERT_EQ(read.size(), exact.size()) << "view " << v;
    for (const GroundTruthObject& object : exact) {
      const auto same = std::ranges::find(read, object.object, &GroundTruthObject::object);
      ASSERT_NE(same, read.end());
      EXPECT_TRUE(is_same_pose(same->camera_from_object, object.camera_from_object));
      EXPECT_NEAR(same->visible_share, object.visible_share, 0.05) << object.object << " view " << v;
    }
  }
}

TEST_F(ExportAnnotationTest, MasksAndFilesOfTuwAreThere) {
  write();
  const fs::path bop = folder_ / "export" / "bop" / "small";
  const auto whole = read_mask(bop / "mask" / "000000_000000.png");
  const auto visible = read_mask(bop / "mask_visib" / "000000_000000.png");
  ASSERT_TRUE(whole.ok() && visible.ok());
  const auto count = [](const Image<std::uint8_t>& mask) { return std::ranges::count(mask.data(), 255); };
  EXPECT_GT(count(*whole), 500);
  EXPECT_LE(count(*visible), count(*whole));
  const std::string view = scene_->view_name(0);
  EXPECT_TRUE(fs::exists(folder_ / "export" / "tuw" / "small" / (view + ".anno")));
  EXPECT_TRUE(fs::exists(folder_ / "export" / "tuw" / "small" / (view + "_cereal_blue_0.txt")));
  EXPECT_TRUE(fs::exists(folder_ / "export" / "tuw" / "small.changes"));
}

TEST_F(ExportAnnotationTest, ObjectsBehindTheCameraHaveNoMask) {
  ObjectMaskRenderer renderer(scene_->library);
  const RgbdFrame& frame = scene_->frames[0];
  AnnotatedObject object;
  object.object = 0;
  object.world_from_object = frame.world_from_camera * Rigid3::from_translation({0, 0, -0.6});
  EXPECT_TRUE(renderer.render({&object, 1}, frame).empty());
  object.world_from_object = frame.world_from_camera * Rigid3::from_translation({0, 0, 0.6});
  EXPECT_EQ(renderer.render({&object, 1}, frame).size(), 1U);
}

TEST_F(ExportAnnotationTest, AnExportReplacesAnEarlierOneAndNothingElse) {
  write();
  scene_->document.objects.clear();
  write();
  EXPECT_FALSE(fs::exists(folder_ / "export" / "bop" / "small" / "mask"));
  fs::remove_all(folder_ / "export");
  fs::create_directories(folder_ / "export");
  std::ofstream(folder_ / "export" / "thesis.tex") << "text";
  ViewStore views(scene_);
  EXPECT_FALSE(
      export_annotation(scene_->document, scene_->library, proposals_, views, "small", folder_ / "export").ok());
  EXPECT_TRUE(fs::exists(folder_ / "export" / "thesis.tex"));
}

// Killed between the two renames, the command has left no export but both halves of the exchange.
TEST_F(ExportAnnotationTest, AnExchangeThatWasKilledIsMended) {
  write();
  fs::rename(folder_ / "export", folder_ / ".export.resight-old");
  fs::create_directories(folder_ / ".export.resight-new" / "bop");
  write();
  EXPECT_TRUE(fs::exists(folder_ / "export" / "bop" / "small" / "scene_gt.json"));
  EXPECT_FALSE(fs::exists(folder_ / ".export.resight-old"));
  EXPECT_FALSE(fs::exists(folder_ / ".export.resight-new"));
}

TEST_F(ExportAnnotationTest, AcceptedRegionsHaveTheirMasks) {
  const AnnotatedObject& first = scene_->document.objects.begin()->second;
  const auto judge = [&](const RegionKey& region, RegionVerdict verdict, std::optional<PixelRuns> mask) {
    scene_->document.regions[region] = {
        .region = region, .verdict = verdict, .track = first.track, .mask = std::move(mask)};
  };
  for (int i = 0; i < 3; ++i) {
    ChangeProposal proposal;
    proposal.view = 3;
    proposal.box.world_from_box = Rigid3::from_translation({0.5 * i, 0, 0});
    proposal.pixels = {{100 * i, 7}};
    proposals_.push_back(proposal);
  }
  judge(proposals_[0].key(), RegionVerdict::kAccepted, std::nullopt);
  judge(proposals_[1].key(), RegionVerdict::kRejected, std::nullopt);
  judge(proposals_[2].key(), RegionVerdict::kAccepted, PixelRuns{{40, 2}, {321, 5}});
  write();
  const fs::path regions = folder_ / "export" / "regions";
  const auto list = nlohmann::json::parse(*read_file(regions / "regions.json"))["regions"];
  ASSERT_EQ(list.size(), 2U) << "the rejected one is none";
  EXPECT_EQ(list[0]["corrected"], false);
  EXPECT_EQ(list[1]["corrected"], true);
  EXPECT_EQ(list[1]["object"], scene_->library.objects[static_cast<std::size_t>(first.object)].name);
  const auto proposed = read_mask(regions / list[0]["mask"].get<std::string>());
  const auto corrected = read_mask(regions / list[1]["mask"].get<std::string>());
  ASSERT_TRUE(proposed.ok() && corrected.ok());
  EXPECT_EQ(find_runs(*proposed), (PixelRuns{{0, 7}}));
  EXPECT_EQ(find_runs(*corrected), (PixelRuns{{40, 2}, {321, 5}}));
}

TEST_F(ExportAnnotationTest, ChecksNameWhatDoesNotFit) {
  using ToDo = AnnotationToDo::Kind;
  AnnotationDocument& document = scene_->document;
  EXPECT_TRUE(find_to_dos(document, scene_->library, {}).empty());
  AnnotatedObject& first = document.objects.begin()->second;
  first.last_view = 1;
  auto to_dos = find_to_dos(document, scene_->library, {});
  ASSERT_EQ(to_dos.size(), 1U);
  EXPECT_EQ(to_dos[0].kind, ToDo::kGap);
  first.last_view = 4;
  to_dos = find_to_dos(document, scene_->library, {});
  ASSERT_EQ(to_dos.size(), 1U);
  EXPECT_EQ(to_dos[0].kind, ToDo::kTwoPlaces);
}

TEST_F(ExportAnnotationTest, ChecksOfThousandsOfPlacementsAreShort) {
  AnnotationDocument document;
  constexpr int kNumPlacements = 3000;
  for (int id = 0; id < kNumPlacements; ++id) {
    AnnotatedObject object = scene_->document.objects.at(0);
    object.id = object.track = id;
    document.objects[id] = object;
  }
  const auto to_dos = find_to_dos(document, scene_->library, {});
  ASSERT_EQ(to_dos.size(), kNumPlacements - 1U) << "each is at the place of another, but not of all others";
  EXPECT_EQ(to_dos[0].kind, AnnotationToDo::Kind::kSamePlace);
  EXPECT_EQ(to_dos[0].track, 1);
}

}  // namespace
}  // namespace resight
