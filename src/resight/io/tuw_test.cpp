// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <cmath>

#include "resight/io/internal/test_data.hpp"
#include "resight/io/organized_pcd.hpp"
#include "resight/io/tuw_changes.hpp"
#include "resight/io/tuw_ground_truth.hpp"
#include "resight/io/tuw_models.hpp"

namespace resight {
namespace {

using testing::HasSubstr;

void write_views(const std::filesystem::path& directory, const std::vector<std::string>& names) {
  for (std::size_t i = 0; i < names.size(); ++i) {
    std::filesystem::create_directories(directory);
    ASSERT_TRUE(write_pcd(directory / (names[i] + ".pcd"), to_pcd_cloud(io::random_frame(names[i], i))).ok());
  }
}

const std::string kPose = "1 0 0 0.1 0 1 0 0.2 0 0 1 0.9 0 0 0 1";

TEST(TuwSequence, PoseFilesInTheSequenceFolder) {
  io::TestDirectory directory;
  write_views(directory.path(), {"cloud_9", "cloud_10"});
  // Another number of digits, underscores in names, and files to be ignored.
  io::write_text(directory / "cloud_09_red_mug_white_spots_0.txt", kPose);
  io::write_text(directory / "cloud_09_occlusion_red_mug_white_spots_0.txt", "0.75\n");
  io::write_text(directory / "cloud_09_red_mug_white_spots_1.txt", kPose);
  io::write_text(directory / "cloud_10_object_01_0.txt", kPose);
  io::write_text(directory / "transformation_cloud_09.txt", kPose);
  io::write_text(directory / "times.txt", "1 2");
  io::write_text(directory / "results_3d.txt", "x");
  const auto sequence = open_sequence(directory.path());
  ASSERT_TRUE(sequence.ok()) << sequence.error().message;
  ASSERT_EQ((*sequence)->num_views(), 2);
  EXPECT_EQ((*sequence)->view_name(0), "cloud_9") << "must sort by numbers, not by letters";
  EXPECT_TRUE((*sequence)->has_ground_truth());
  const auto first = (*sequence)->read_ground_truth(0);
  ASSERT_TRUE(first.ok()) << first.error().message;
  ASSERT_EQ(first->size(), 2U);
  EXPECT_EQ((*first)[0].object, "red_mug_white_spots");
  EXPECT_DOUBLE_EQ((*first)[0].visible_share, 0.25);
  EXPECT_EQ((*first)[0].camera_from_object.translation, Eigen::Vector3d(0.1, 0.2, 0.9));
  EXPECT_EQ((*first)[1].instance, 1);
  EXPECT_TRUE(std::isnan((*first)[1].visible_share));
  const auto second = (*sequence)->read_ground_truth(1);
  ASSERT_EQ(second->size(), 1U);
  EXPECT_EQ((*second)[0].object, "object_01");
}

TEST(TuwSequence, AnnotationsBesideTheTestSet) {
  io::TestDirectory directory;
  write_views(directory / "test_set/set_00001", {"00000", "00001"});
  write_views(directory / "test_set/set_00002", {"00000"});
  io::write_text(directory / "annotations/set_00001/00001.anno",
                 "mug (0.5): " + kPose + "\n\nmug (1): " + kPose + "\nbox (0): " + kPose);
  const auto sequence = open_sequence(directory / "test_set/set_00001");
  ASSERT_TRUE(sequence.ok()) << sequence.error().message;
  const auto truth = (*sequence)->read_ground_truth(1);
  ASSERT_TRUE(truth.ok()) << truth.error().message;
  ASSERT_EQ(truth->size(), 3U);
  EXPECT_EQ((*truth)[1].object, "mug");
  EXPECT_EQ((*truth)[1].instance, 1);
  EXPECT_EQ((*truth)[0].visible_share, 0.5);
  EXPECT_TRUE((*sequence)->read_ground_truth(0)->empty());
  EXPECT_FALSE((*open_sequence(directory / "test_set/set_00002"))->has_ground_truth());
  EXPECT_THAT(open_sequence(directory / "test_set").error().message, HasSubstr("holds 2 sequences"));
}

TEST(TuwSequence, TheRootOfADataSetHoldsIt) {
  io::TestDirectory directory;
  const std::vector<TrainingView> views = {io::random_training_view("cloud_0", 1)};
  ASSERT_TRUE(write_tuw_model(directory / "models", "mug", views, nullptr).ok());
  write_views(directory / "test/table", {"00000"});
  const auto found = find_sequence_folder(directory.path());
  ASSERT_TRUE(found.ok()) << found.error().message;
  EXPECT_EQ(*found, directory / "test/table");
  write_views(directory / "train/table", {"00000"});
  EXPECT_TRUE(open_sequence(directory.path()).ok()) << "test scenes are preferred";
  write_views(directory / "test/shelf", {"00000"});
  EXPECT_THAT(open_sequence(directory.path()).error().message, HasSubstr("holds 2 sequences"));
}

TEST(TuwSequence, TheViewsOfAModelAreNone) {
  io::TestDirectory directory;
  const std::vector<TrainingView> views = {io::random_training_view("cloud_0", 1)};
  ASSERT_TRUE(write_tuw_model(directory.path(), "mug", views, nullptr).ok());
  EXPECT_THAT(find_sequence_folders(directory / "mug"), testing::IsEmpty());
  EXPECT_THAT(find_sequence_folders(directory.path()), testing::IsEmpty());
  EXPECT_THAT(open_sequence(directory / "mug").error().message, HasSubstr("no sequence found"));
  EXPECT_TRUE(open_sequence(directory / "mug/views").ok()) << "unless they are named";
}

TEST(TuwSequence, BadTruthNamesItsFile) {
  io::TestDirectory directory;
  write_views(directory.path(), {"00000"});
  io::write_text(directory / "00000_mug_0.txt", "1 0 0");
  const auto sequence = open_sequence(directory.path());
  EXPECT_THAT((*sequence)->read_ground_truth(0).error().message, HasSubstr("00000_mug_0.txt: "));
  io::write_text(directory / "00000_mug_0.txt", kPose);
  io::write_text(directory / "00000_occlusion_mug_0.txt", "7");
  EXPECT_THAT((*open_sequence(directory.path()))->read_ground_truth(0).error().message,
              HasSubstr("00000_occlusion_mug_0.txt: "));
}

TEST(TuwSequence, NamesThatCannotBeThoseOfObjectsAreRefused) {
  for (const char* name : {"\x1b[31mmug", "a\nresight: done", "\\x", ".."}) {
    io::TestDirectory directory;
    write_views(directory.path(), {"00000"});
    io::write_text(directory / ("00000_" + std::string(name) + "_0.txt"), kPose);
    const auto truth = (*open_sequence(directory.path()))->read_ground_truth(0);
    ASSERT_FALSE(truth.ok()) << name;
    EXPECT_THAT(truth.error().message, HasSubstr("control characters or slashes"));
    EXPECT_THAT(truth.error().message, HasSubstr("00000_"));
  }
  EXPECT_THAT(parse_tuw_anno("../../x (1): " + kPose, "f.anno").error().message, HasSubstr("f.anno: line 1: the name"));
  EXPECT_THAT(parse_tuw_anno(std::string(1000, 'a') + " (1): " + kPose, "f").error().message, HasSubstr("1000 bytes"));
}

TEST(TuwSequence, ObjectsThatWouldBeTakenForOcclusionsAreRefused) {
  io::TestDirectory directory;
  for (const char* name : {"occlusion", "occlusion_cup"})
    EXPECT_THAT(write_tuw_annotation(directory.path(), "view_1", {{name, 0, 0, {}, 0.5}}).error().message,
                HasSubstr("rename the object"));
  ASSERT_TRUE(write_tuw_annotation(directory.path(), "view_1", {{"occlusions", 0, 0, {}, 0.5}}).ok());
  const auto found = find_tuw_annotations(directory.path(), {"view_1"});
  ASSERT_EQ(found[0].poses.size(), 1U);
  EXPECT_EQ(found[0].poses[0].object, "occlusions");
}

TEST(TuwSequence, WriterKeepsViewsAndTruth) {
  io::TestDirectory directory;
  const auto writer = create_sequence(directory / "out", DatasetFormat::kTuw);
  ASSERT_TRUE(writer.ok());
  std::vector<GroundTruthObject> truth(3);
  Rng rng(1);
  for (int i = 0; i < 3; ++i)
    truth[i] = {i < 2 ? "a_b" : "c", 0, i, io::random_pose(rng), i == 0 ? std::nan("") : 0.25 * i};
  const RgbdFrame first = io::random_frame("view_3", 1);
  ASSERT_TRUE((*writer)->write_view(first, truth).ok());
  EXPECT_THAT((*writer)->write_view(io::random_frame("view_2", 2), {}).error().message, HasSubstr("ascend"));
  EXPECT_THAT((*writer)->write_view(io::random_frame("../x", 2), {}).error().message, HasSubstr("file name"));
  EXPECT_FALSE(std::filesystem::exists(directory / "out"));
  ASSERT_TRUE((*writer)->finish().ok());
  const auto sequence = open_sequence(directory / "out");
  ASSERT_TRUE(sequence.ok()) << sequence.error().message;
  const auto frame = (*sequence)->read_view(0);
  ASSERT_TRUE(frame.ok()) << frame.error().message;
  EXPECT_EQ(frame->name, "view_3");
  EXPECT_EQ(frame->camera, first.camera);
  EXPECT_EQ(frame->color, first.color);
  EXPECT_EQ(io::depth_difference_m(frame->depth_m, first.depth_m), 0);
  EXPECT_LT(io::pose_difference(frame->world_from_camera, first.world_from_camera), 1e-14);
  const auto read = (*sequence)->read_ground_truth(0);
  ASSERT_TRUE(read.ok()) << read.error().message;
  ASSERT_EQ(read->size(), 3U);
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ((*read)[i].object, truth[i].object);
    EXPECT_EQ((*read)[i].instance, truth[i].instance);
    EXPECT_EQ(io::pose_difference((*read)[i].camera_from_object, truth[i].camera_from_object), 0);
    EXPECT_TRUE(i == 0 || std::abs((*read)[i].visible_share - truth[i].visible_share) < 1e-15);
  }
  EXPECT_TRUE(std::isnan((*read)[0].visible_share));
}

TEST(TuwAnno, ReadsShareAndPoseOfEachInstance) {
  const auto read = parse_tuw_anno("a_b (0.125): " + kPose + "\na_b (1): " + kPose + "\n", "test");
  ASSERT_TRUE(read.ok()) << read.error().message;
  ASSERT_EQ(read->size(), 2U);
  EXPECT_EQ((*read)[0].object, "a_b");
  EXPECT_EQ((*read)[0].visible_share, 0.125);
  EXPECT_EQ((*read)[0].instance, 0);
  EXPECT_EQ((*read)[1].instance, 1);
  EXPECT_EQ(io::pose_difference((*read)[0].camera_from_object, (*read)[1].camera_from_object), 0);
}

TEST(TuwAnno, BadLines) {
  for (const std::string& line : {"mug 0.5: " + kPose, "mug (x): " + kPose, "mug (0.5) " + kPose, "(0.5): " + kPose,
                                  std::string("mug (0.5): 1 2 3"), "mug (3): " + kPose}) {
    const auto read = parse_tuw_anno("\n" + line, "f.anno");
    ASSERT_FALSE(read.ok()) << line;
    EXPECT_THAT(read.error().message, HasSubstr("f.anno: line 2"));
  }
}

TEST(Changes, ReadsAnyWidthAndWritesSorted) {
  io::TestDirectory directory;
  const auto chains = parse_changes(
      "cloud_03_mug_0.txt  cloud_4_mug_1.txt cloud_0011_mug_1.txt \n\ncloud_00_asus_box_0.txt\r\n00000_mug_0.txt "
      "00001_mug_0.txt",
      "c");
  ASSERT_TRUE(chains.ok()) << chains.error().message;
  ASSERT_EQ(chains->size(), 3U);
  EXPECT_EQ((*chains)[0].entries[2].view_number, 11);
  EXPECT_EQ((*chains)[0].entries[1].instance, 1);
  EXPECT_EQ((*chains)[1].entries[0].object, "asus_box");
  ASSERT_TRUE(write_changes(directory / "set.changes", *chains).ok());
  EXPECT_EQ(io::read_text(directory / "set.changes"),
            "cloud_00_asus_box_0.txt\n00000_mug_0.txt 00001_mug_0.txt\ncloud_03_mug_0.txt cloud_4_mug_1.txt "
            "cloud_0011_mug_1.txt\n");
  EXPECT_EQ(read_changes(directory / "set.changes")->size(), 3U);
}

TEST(Changes, BadLines) {
  const auto message = [](const std::string& text) {
    const auto chains = parse_changes(text, "f.changes");
    return chains.ok() ? std::string("no error") : chains.error().message;
  };
  EXPECT_THAT(message("cloud_00_mug_0.txt cloud_01_box_0.txt"), HasSubstr("two different objects"));
  EXPECT_THAT(message("cloud_01_mug_0.txt cloud_01_mug_1.txt"), HasSubstr("do not ascend"));
  EXPECT_THAT(message("cloud_01_mug_0.txt\ncloud_1_mug_0.txt"),
              HasSubstr("line 2: an annotation that another chain has"));
  EXPECT_THAT(message("mug.txt"), HasSubstr("expected names"));
  EXPECT_THAT(message("cloud_00_../../x_0.txt"), HasSubstr("line 1: the name of an object '../../x' has"));
}

}  // namespace
}  // namespace resight
