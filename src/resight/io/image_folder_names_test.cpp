// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <cmath>

#include "resight/io/image_folder_test_util.hpp"
#include "resight/io/internal/image_series.hpp"
#include "resight/io/internal/trajectory_file.hpp"

namespace resight {
namespace {

using namespace test;
using testing::HasSubstr;

TEST(ImageFolder, PosesBesideNumpyDepthAreRead) {
  io::TestDirectory directory;
  write_layout(directory.path(), kNumpy);
  io::write_text(directory / "cam_K.txt", kMatrix);
  EXPECT_EQ((*open_posed_sequence(directory.path()))->format(), "npy");
  EXPECT_THAT((*open_posed_sequence(directory.path()))->notes(), testing::Contains(HasSubstr("stand still")));
  const std::string rows = "1 0 0 1 0 1 0 2 0 0 1 3 0 0 0 1\n";
  // Neither is a list of camera poses.
  io::write_text(directory / "extrinsics.txt", rows);
  io::write_text(directory / "object_poses.csv", "cup, 1, here, there\n");
  EXPECT_EQ((*open_posed_sequence(directory.path()))->format(), "npy");
  std::filesystem::remove(directory / "object_poses.csv");
  io::write_text(directory / "poses.txt", rows + rows + rows);
  const auto posed = open_posed_sequence(directory.path());
  ASSERT_TRUE(posed.ok()) << posed.error().message;
  EXPECT_EQ((*posed)->read_pose(1)->translation, Eigen::Vector3d(1, 2, 3));
}

/// Series of one file each, all of the same number.
std::vector<io::FileSeries> make_image_series(int count) {
  std::vector<io::FileSeries> all;
  for (int i = 0; i < count; ++i)
    for (const io::SeriesKind kind : {io::SeriesKind::kColor, io::SeriesKind::kDepth}) {
      const std::string name = std::string(static_cast<std::size_t>(i % 80), 'a') + std::to_string(i / 80) + "b1.png";
      io::FileSeries series{.folder = "views", .pattern = name, .kind = kind, .files = {}};
      series.files.emplace("1", io::SeriesFile{.file = series.folder / name, .name = name});
      all.push_back(std::move(series));
    }
  return all;
}

TEST(ImageFolder, ManySeriesNeedNoMemoryForTheirPairs) {
  const std::vector<io::FileSeries> all = make_image_series(300);
  const io::MemoryGrowth growth;
  EXPECT_THAT(io::pair_series(all, "views").error().message, HasSubstr("holds several series of views"));
  EXPECT_LT(growth.bytes(), 100'000'000U);
}

TEST(ImageFolder, MoreSeriesThanCanBePairedAreRefused) {
  EXPECT_THAT(io::pair_series(make_image_series(1001), "views").error().message,
              HasSubstr("holds too many series of images (1001 of colour and 1001 of depth)"));
}

TEST(ImageFolder, NamesThatAreTimes) {
  io::TestDirectory directory;
  const std::vector<std::pair<std::string, std::string>> times = {{"1305031102.175304", "1305031102.160407"},
                                                                  {"1305031102.211214", "1305031102.226738"},
                                                                  {"1305031103.005100", "1305031102.999000"},
                                                                  {"1305031104.500000", "1305031109.500000"}};
  for (const auto& [color, depth] : times) {
    ASSERT_TRUE(write_color(directory / "rgb" / (color + ".jpg"), Image<Rgb8>(kWidth, kHeight)).ok());
    ASSERT_TRUE(write_depth(directory / "depth" / (depth + ".png"), Image<float>(kWidth, kHeight, 1.5F), 0.001).ok());
  }
  io::write_text(directory / "intrinsics.txt", kMatrix);
  io::write_text(directory / "groundtruth.txt",
                 "1305031102.16 1 0 0 0 0 0 1\n1305031102.2 2 0 0 0 0 0 1\n1305031102.25 2 0 0 0 0 0 1\n"
                 "1305031102.99 3 0 0 0 0 0 1\n1305031103.01 3 0 0 0 0 0 1\n");
  const auto sequence = open_posed_sequence(directory.path());
  ASSERT_TRUE(sequence.ok()) << sequence.error().message;
  ASSERT_EQ((*sequence)->num_views(), 3) << "the last two images are 5 s apart";
  EXPECT_EQ((*sequence)->view_name(2), "1305031103.005100");
  EXPECT_NEAR((*sequence)->read_pose(0)->translation.x(), 1 + 0.000407 / 0.04, 1e-4);
  EXPECT_NEAR((*sequence)->read_pose(2)->translation.x(), 3, 1e-6);
}

// A program writes fractions without the zeros at their end, and one trigger may give both images one time.
TEST(ImageFolder, TimesArePairedAndOrderedAsNumbers) {
  io::TestDirectory directory;
  const std::vector<std::pair<std::string, std::string>> times = {{"1700000000.05", "1700000000.05"},
                                                                  {"1700000000.5", "1700000000.507"},
                                                                  {"1700000001.05", "1700000001.057"},
                                                                  {"1700000001.1", "1700000001.107"}};
  for (const auto& [color, depth] : times) {
    ASSERT_TRUE(write_color(directory / "rgb" / (color + ".jpg"), Image<Rgb8>(kWidth, kHeight)).ok());
    ASSERT_TRUE(write_depth(directory / "depth" / (depth + ".png"), Image<float>(kWidth, kHeight, 1.5F), 0.001).ok());
  }
  io::write_text(directory / "intrinsics.txt", kMatrix);
  const auto sequence = open_sequence(directory.path());
  ASSERT_TRUE(sequence.ok()) << sequence.error().message;
  ASSERT_EQ((*sequence)->num_views(), 4);
  for (int v = 0; v < 4; ++v) EXPECT_EQ((*sequence)->view_name(v), times[static_cast<std::size_t>(v)].first);
}

// As with --follow, when the first view is there alone.
TEST(ImageFolder, TheNameOfAViewStaysWhenOthersFollow) {
  for (const auto& [first, second] : {std::pair<std::string, std::string>{"cam1_#_0001", "cam1_#_0002"},
                                      {"#_0001_cam1", "#_0002_cam1"},
                                      {"cam1_#_1305031102.175304", "cam1_#_1305031102.211214"},
                                      {"1305031102.175304", "1305031103.005100"}}) {
    io::TestDirectory directory;
    const auto write_pair = [&](std::string color, std::string depth) {
      if (const std::size_t kind = color.find('#'); kind != std::string::npos) {
        color.replace(kind, 1, "color");
        depth.replace(kind, 1, "depth");
      }
      ASSERT_TRUE(write_color(directory / "rgb" / (color + ".png"), Image<Rgb8>(kWidth, kHeight)).ok());
      ASSERT_TRUE(write_depth(directory / "depth" / (depth + ".png"), Image<float>(kWidth, kHeight, 1.5F), 0.001).ok());
    };
    io::write_text(directory / "intrinsics.txt", kMatrix);
    write_pair(first, first);
    const auto alone = open_sequence(directory.path());
    ASSERT_TRUE(alone.ok()) << alone.error().message;
    ASSERT_EQ((*alone)->num_views(), 1);
    const std::string name = (*alone)->view_name(0);
    write_pair(second, second);
    const auto both = open_sequence(directory.path());
    ASSERT_TRUE(both.ok()) << both.error().message;
    ASSERT_EQ((*both)->num_views(), 2);
    EXPECT_EQ((*both)->view_name(0), name);
  }
}

TEST(ImageFolder, SinglePairsAreComparedByTimeOrNumber) {
  const auto num_views = [](const std::string& color, const std::string& depth) {
    io::TestDirectory directory;
    EXPECT_TRUE(write_color(directory / "rgb" / (color + ".jpg"), Image<Rgb8>(kWidth, kHeight)).ok());
    EXPECT_TRUE(write_depth(directory / "depth" / (depth + ".png"), Image<float>(kWidth, kHeight, 1.5F), 0.001).ok());
    io::write_text(directory / "intrinsics.txt", kMatrix);
    const auto sequence = open_sequence(directory.path());
    return sequence.ok() ? (*sequence)->num_views() : 0;
  };
  EXPECT_EQ(num_views("1305031102.175304", "1305031102.160407"), 1);
  EXPECT_EQ(num_views("1305031102.175304", "1305031102.975304"), 0) << "0.8 s apart";
  EXPECT_EQ(num_views("1305031102.5", "1305031109.5"), 0) << "only the fractions agree";
  EXPECT_EQ(num_views("0001_cam1", "0001_cam2"), 1);
  EXPECT_EQ(num_views("0001_cam1", "0002_cam1"), 0) << "only the cameras agree";
}

TEST(ImageFolder, NamesThatAreMillisecondsWithFractions) {
  io::TestDirectory directory;
  for (const auto& [color, depth] : {std::pair{"1600000000000.12012", "1600000000005.12012"},
                                     {"1600000000033.42017", "1600000000038.42017"},
                                     {"1600000000066.72021", "1600000000097.72021"}}) {
    ASSERT_TRUE(
        write_color(directory / (std::string("rec_Color_") + color + ".png"), Image<Rgb8>(kWidth, kHeight)).ok());
    ASSERT_TRUE(write_depth(directory / (std::string("rec_Depth_") + depth + ".png"),
                            Image<float>(kWidth, kHeight, 1.5F), 0.001)
                    .ok());
  }
  io::write_text(directory / "intrinsics.txt", kMatrix);
  const auto sequence = open_sequence(directory.path());
  ASSERT_TRUE(sequence.ok()) << sequence.error().message;
  EXPECT_EQ((*sequence)->num_views(), 2) << "the last two images are 31 ms apart";
}

TEST(ImageFolder, NamesWithoutNumbersArePairedByName) {
  io::TestDirectory directory;
  const auto write_pair = [&](const std::string& color, const std::string& depth) {
    ASSERT_TRUE(write_color(directory / color, Image<Rgb8>(kWidth, kHeight)).ok());
    ASSERT_TRUE(write_depth(directory / depth, Image<float>(kWidth, kHeight, 1.0F), 0.001).ok());
  };
  const auto num_views = [&](const std::string& folder) {
    io::write_text(directory / folder / "intrinsics.txt", kMatrix);
    const auto sequence = open_sequence(directory / folder);
    return sequence.ok() ? (*sequence)->num_views() : 0;
  };
  write_pair("a/rgb/apple.png", "a/depth/apple.png");
  write_pair("a/rgb/bed.png", "a/depth/bed.png");
  EXPECT_EQ(num_views("a"), 2);
  write_pair("b/cup_color.png", "b/cup_depth.png");
  write_pair("b/door_color.png", "b/door_depth.png");
  EXPECT_EQ(num_views("b"), 2);
  write_pair("c/color.png", "c/depth.png");
  EXPECT_EQ(num_views("c"), 1);
  write_pair("e/color.png", "e/depth.png");
  ASSERT_TRUE(write_depth(directory / "e/aligned_depth.png", Image<float>(kWidth, kHeight, 2.0F), 0.001).ok());
  EXPECT_EQ(num_views("e"), 1);
  EXPECT_EQ((*open_sequence(directory / "e"))->read_view(0)->depth_m(0, 0), 2) << "of two, the registered one";
  write_pair("f/mug_color.png", "f/mug_depth.png");
  write_pair("f/mug2_color.png", "f/mug2_depth.png");
  write_pair("f/mug3_color.png", "f/mug3_depth.png");
  EXPECT_EQ(num_views("f"), 2);
  EXPECT_THAT((*open_sequence(directory / "f"))->notes(), testing::Contains(HasSubstr("which are left out: 1")));
  write_pair("d/rgb/apple.png", "d/depth/bed.png");
  EXPECT_EQ(num_views("d"), 0) << "two views that have nothing to do with each other";
}

TEST(ImageFolder, SeveralSeriesAreNotGuessed) {
  io::TestDirectory directory;
  FolderLayout first = kSevenScenes;
  first.color_prefix = first.depth_prefix = "a_";
  FolderLayout second = kSevenScenes;
  second.color_prefix = second.depth_prefix = "b_";
  write_layout(directory.path(), first);
  write_layout(directory.path(), second);
  io::write_text(directory / "intrinsics.txt", kMatrix);
  EXPECT_THAT(open_sequence(directory.path()).error().message, HasSubstr("several series of views"));
}

TEST(ImageFolder, PosesPerView) {
  io::TestDirectory directory;
  write_layout(directory.path(), kSevenScenes);
  io::write_text(directory / "intrinsics.txt", kMatrix);
  io::write_text(directory / "frame-000000.pose.txt", "1 0 0 1\n0 1 0 2\n0 0 1 3\n0 0 0 1\n");
  io::write_text(directory / "frame-000001.pose.txt", "nan nan nan nan nan nan nan nan nan nan nan nan 0 0 0 1\n");
  io::write_text(directory / "frame-000002.pose.txt", "1 0 0 4\n0 1 0 5\n0 0 1 6\n0 0 0 1\n");
  const auto sequence = open_posed_sequence(directory.path());
  ASSERT_TRUE(sequence.ok()) << sequence.error().message;
  ASSERT_EQ((*sequence)->num_views(), 2) << "a view that was not tracked is left out";
  EXPECT_EQ((*sequence)->view_name(1), "frame-000002");
  EXPECT_EQ((*sequence)->read_pose(1)->translation, Eigen::Vector3d(4, 5, 6));
  OpenSequenceOptions options;
  options.pose_convention = PoseConvention::kWorldToCamera;
  EXPECT_EQ((*open_sequence(directory.path(), options))->read_pose(1)->translation, Eigen::Vector3d(-4, -5, -6));
  options.pose_convention = PoseConvention::kOpenGl;
  EXPECT_EQ((*open_sequence(directory.path(), options))->read_pose(1)->rotation(1, 1), -1);
}

TEST(ImageFolder, ViewsAreChosenByMotion) {
  io::TestDirectory directory;
  FolderLayout layout = kTwoFolders;
  layout.count = 5;
  write_layout(directory.path(), layout);
  io::write_text(directory / "intrinsics.txt", kMatrix);
  OpenSequenceOptions options;
  options.views.min_motion_m = 0.1;
  EXPECT_THAT(open_sequence(directory.path(), options).error().message,
              HasSubstr("no poses, which --min-motion needs"));
  // 6 cm further each time, and then 0.2 rad about y: what is 1 m ahead moves by 0.2 m.
  io::write_text(directory / "poses.txt",
                 "0 0 0 0 0 0 0 1\n1 .06 0 0 0 0 0 1\n2 .12 0 0 0 0 0 1\n3 .18 0 0 0 0 0 1\n"
                 "4 .18 0 0 0 0.0998334 0 0.9950042\n");
  const auto sequence = open_sequence(directory.path(), options);
  ASSERT_TRUE(sequence.ok()) << sequence.error().message;
  ASSERT_EQ((*sequence)->num_views(), 3);
  EXPECT_EQ((*sequence)->view_name(1), "000002");
  EXPECT_EQ((*sequence)->view_name(2), "000004");
  EXPECT_THAT((*sequence)->notes(), testing::Contains(HasSubstr("3 of 5 views are used (--min-motion)")));
  options.views.min_motion_m = std::nan("");
  EXPECT_THAT(open_sequence(directory.path(), options).error().message, HasSubstr("--min-motion must not be negative"));
}

TEST(ImageFolder, PoseFilesOfAllForms) {
  io::TestDirectory directory;
  write_layout(directory.path(), kTwoFolders);
  io::write_text(directory / "intrinsics.txt", kMatrix);
  const std::string rows16 = "1 0 0 1 0 1 0 2 0 0 1 3 0 0 0 1\n";
  const std::string block = "1 0 0 1\n0 1 0 2\n0 0 1 3\n0 0 0 1\n";
  OpenSequenceOptions options;
  options.poses = (directory / "given").string();
  for (const std::string& text :
       {rows16 + rows16 + rows16, block + block + block, "0 0 1\n" + block + "1 1 2\n" + block + "2 2 3\n" + block,
        std::string("# stamp\n0 1 2 3 0 0 0 1\n1 1 2 3 0 0 0 1\n2 1 2 3 0 0 0 1\n"),
        std::string("timestamp, frame, x, y, z, qx, qy, qz, qw\n0, 0, 1, 2, 3, 0, 0, 0, 1\n1, 1, 1, 2, 3, 0, 0, 0, 1\n"
                    "2, 2, 1, 2, 3, 0, 0, 0, 1\n")}) {
    io::write_text(directory / "given", text);
    const auto sequence = open_posed_sequence(directory.path(), options);
    ASSERT_TRUE(sequence.ok()) << sequence.error().message << "\n" << text;
    ASSERT_EQ((*sequence)->num_views(), 3) << text;
    EXPECT_EQ((*sequence)->read_pose(2)->translation, Eigen::Vector3d(1, 2, 3)) << text;
  }
  io::write_text(
      directory / "given",
      "timestamp, frame, x, y, z, qx, qy, qz, qw\n3.2, 0, 7, 0, 0, 0, 0, 0, 1\n4.5, 2, 9, 0, 0, 0, 0, 0, 1\n");
  const auto numbered_views = open_posed_sequence(directory.path(), options);
  ASSERT_TRUE(numbered_views.ok()) << numbered_views.error().message;
  ASSERT_EQ((*numbered_views)->num_views(), 2) << "by the column of numbers";
  EXPECT_EQ((*numbered_views)->read_pose(1)->translation.x(), 9);
  // Times are no numbers of views, even if some are whole.
  io::write_text(directory / "given", "1.0 3 0 0 0 0 0 1\n0.0 1 0 0 0 0 0 1\n0.5 2 0 0 0 0 0 1\n");
  const auto in_order = open_posed_sequence(directory.path(), options);
  ASSERT_TRUE(in_order.ok()) << in_order.error().message;
  ASSERT_EQ((*in_order)->num_views(), 3);
  for (int v = 0; v < 3; ++v) EXPECT_EQ((*in_order)->read_pose(v)->translation.x(), v + 1);
  EXPECT_THAT((*in_order)->notes(), testing::Contains(HasSubstr("in the order of the views")));
  io::write_text(directory / "given", "0.0 1 0 0 0 0 0 1\n0.5 2 0 0 0 0 0 1\n");
  EXPECT_THAT(open_sequence(directory.path(), options).error().message,
              HasSubstr("2 poses with times, which the names of the images do not tell, for 3 views"));
  io::write_text(directory / "given", "0.5 1 0 0 0 0 0 1\n0.5 2 0 0 0 0 0 1\n0.5 3 0 0 0 0 0 1\n");
  EXPECT_THAT(open_sequence(directory.path(), options).error().message, HasSubstr("no names, numbers or times"));
  io::write_text(directory / "given", "a 1 0 0 0 0 0 1\nb 2 0 0 0 0 0 1\nc 3 0 0 0 0 0 1\n");
  EXPECT_THAT(open_sequence(directory.path(), options).error().message, HasSubstr("no names, numbers or times"));
  // Names of files, in another order.
  for (const char* prefix : {"", "rgb/", "pose-"}) {
    std::string text;
    for (const char* v : {"2", "0", "1"}) text += prefix + std::string("00000") + v + ".png " + v + " 0 0 0 0 0 1\n";
    io::write_text(directory / "given", text);
    const auto named = open_posed_sequence(directory.path(), options);
    ASSERT_TRUE(named.ok()) << named.error().message << text;
    ASSERT_EQ((*named)->num_views(), 3);
    for (int v = 0; v < 3; ++v) EXPECT_EQ((*named)->read_pose(v)->translation.x(), v) << text;
  }
  io::write_text(directory / "given", rows16);
  EXPECT_THAT(open_sequence(directory.path(), options).error().message,
              HasSubstr("1 poses without stamps for 3 views"));
  io::write_text(directory / "given", "1 2 3\n");
  EXPECT_THAT(open_sequence(directory.path(), options).error().message, HasSubstr("line 1"));
}

TEST(ImageFolder, TitlesTellTheOrderOfTheColumns) {
  io::TestDirectory directory;
  const auto read = [&](const std::string& text) {
    io::write_text(directory / "poses.csv", text);
    return io::read_pose_list(directory / "poses.csv", true);
  };
  // 120 deg about (1, 1, 1), and half of it about x.
  for (const std::string text :
       {"timestamp,x,y,z,qw,qx,qy,qz\n0,1,2,3,0.5,0.5,0.5,0.5\n1,1,2,3,0.8660254,0.5,0,0\n",
        "time Q_W Q_X Q_Y Q_Z P_X P_Y P_Z\n0 0.5 0.5 0.5 0.5 1 2 3\n1 0.8660254 0.5 0 0 1 2 3\n",
        "t, frame, pos.x, pos.y, pos.z, rotation.w, rotation.x, rotation.y, rotation.z\n"
        "0, 0, 1, 2, 3, 0.5, 0.5, 0.5, 0.5\n1, 1, 1, 2, 3, 0.8660254, 0.5, 0, 0\n"}) {
    const auto poses = read(text);
    ASSERT_TRUE(poses.ok()) << poses.error().message << text;
    ASSERT_EQ(poses->size(), 2U) << text;
    const Rigid3& pose = (*poses)[1].world_from_camera;
    EXPECT_EQ(pose.translation, Eigen::Vector3d(1, 2, 3)) << text;
    EXPECT_LT(rotation_angle_rad(pose.rotation, Rigid3::from_axis_angle({1, 0, 0}, M_PI / 3).rotation), 1e-6) << text;
  }
  for (const std::string title :
       {"time,x,y,z,a,b,c,d", "time,x,y,z,qx,qy,qz", "time,x,y,z,qx,qx,qz,qw", "x,y,z,qx,qy,qz,qw,time"})
    EXPECT_THAT(read(title + "\n0,1,2,3,0,0,0,1\n").error().message, HasSubstr("the title does not name")) << title;
  const auto untracked = read("a.png nan nan nan nan nan nan nan\nb.png 1 2 3 0 0 0 1\n");
  ASSERT_TRUE(untracked.ok()) << untracked.error().message;
  EXPECT_EQ(untracked->size(), 1U) << "no title";
}

// "chair_" holds "ir_", and "television" holds "vis".
TEST(ImageFolder, NamesOfObjectsHoldPartsOfOtherWords) {
  for (const std::string object : {"chair", "classroom", "television", "iron", "conference", "stool"}) {
    io::TestDirectory directory;
    FolderLayout layout{"", object + "_", "_rgb.png", "", object + "_", "_depth.png", 6, 3};
    write_layout(directory.path(), layout);
    // These are still no views of it.
    for (const std::string other : {"_seg", "_mask", "_ir", "_vis", "_conf", "_class", "_InstanceSegmentation"}) {
      layout.color_suffix = other + "_rgb.png";
      layout.depth_suffix = other + "_depth.png";
      write_layout(directory.path(), layout);
    }
    io::write_text(directory / "intrinsics.txt", kMatrix);
    const auto sequence = open_sequence(directory.path());
    ASSERT_TRUE(sequence.ok()) << object << ": " << sequence.error().message;
    EXPECT_EQ((*sequence)->num_views(), 3) << object;
  }
}

TEST(ImageFolder, IntrinsicsAreFoundByContent) {
  io::TestDirectory directory;
  write_layout(directory.path(), kTwoFolders);
  io::write_text(directory / "notes.txt", "1 2 3 4\n");
  io::write_text(directory / "boxes.csv", "500,500,100,100\n");
  EXPECT_THAT(open_sequence(directory.path()).error().message, HasSubstr("no intrinsics"));
  io::write_text(directory / "params.json", R"({"fx": 60, "fy": 61, "cx": 7.5, "cy": 6})");
  const auto sequence = open_sequence(directory.path());
  ASSERT_TRUE(sequence.ok()) << sequence.error().message;
  EXPECT_EQ((*sequence)->read_view(0)->camera.fx, 60);
  // A name that says so wins, and any number of other files does not hide it.
  for (int i = 100; i < 160; ++i) io::write_text(directory / ("frame-" + std::to_string(i) + ".txt"), "1 2 3\n");
  io::write_text(directory / "kinect.txt", "70 71 3.5 2.5\n");
  const auto named = open_sequence(directory.path());
  ASSERT_TRUE(named.ok()) << named.error().message;
  EXPECT_EQ((*named)->read_view(0)->camera.fx, 70);
}

}  // namespace
}  // namespace resight
