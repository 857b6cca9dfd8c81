// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include "resight/io/images.hpp"
#include "resight/io/internal/test_data.hpp"

namespace resight {
namespace {

using testing::HasSubstr;
using testing::Not;

constexpr int kWidth = 8;
constexpr int kHeight = 6;

/// Writes `count` pairs of images: <folder>/<prefix><number><suffix>.
struct FolderLayout {
  std::string color_folder, color_prefix, color_suffix;
  std::string depth_folder, depth_prefix, depth_suffix;
  int digits = 6;
  int count = 3;
};

std::string numbered(const FolderLayout& layout, int number) {
  const std::string digits = std::to_string(number);
  return std::string(static_cast<std::size_t>(layout.digits) - digits.size(), '0') + digits;
}

void write_npy(const std::filesystem::path& file, const Image<float>& depth) {
  std::string dictionary = "{'descr': '<f4', 'fortran_order': False, 'shape': (" + std::to_string(depth.height()) +
                           ", " + std::to_string(depth.width()) + "), }";
  dictionary.resize(118, ' ');
  io::write_text(file, std::string("\x93NUMPY\x01\0", 8) + std::string("\x76\0", 2) + dictionary +
                           std::string(reinterpret_cast<const char*>(depth.data().data()), 4 * depth.size()));
}

void write_layout(const std::filesystem::path& root, const FolderLayout& layout) {
  for (int i = 0; i < layout.count; ++i) {
    const Image<float> depth(kWidth, kHeight, 1.0F + 0.1F * static_cast<float>(i));
    const auto color_file =
        root / layout.color_folder / (layout.color_prefix + numbered(layout, i) + layout.color_suffix);
    const auto depth_file =
        root / layout.depth_folder / (layout.depth_prefix + numbered(layout, i) + layout.depth_suffix);
    ASSERT_TRUE(write_color(color_file, Image<Rgb8>(kWidth, kHeight, Rgb8{90, 120, 200})).ok());
    if (depth_file.extension() == ".npy")
      write_npy(depth_file, depth);
    else
      ASSERT_TRUE(write_depth(depth_file, depth, 0.001).ok());
  }
}

const std::string kMatrix = "60 0 3.5\n0 61 2.5\n0 0 1\n";

/// Layouts that users have.
const FolderLayout kTwoFolders{"color", "", ".jpg", "depth", "", ".png", 6, 3};
const FolderLayout kSevenScenes{"", "frame-", ".color.png", "", "frame-", ".depth.png", 6, 3};
const FolderLayout kOneFolder{"", "color_", ".jpg", "", "depth_", ".png", 1, 3};
const FolderLayout kNumpy{"rgb", "img", ".png", "depth", "img", ".npy", 4, 3};
const FolderLayout kReplica{"results", "frame", ".jpg", "results", "depth", ".png", 6, 3};
const FolderLayout kWithSize{"", "c", "_640x480.png", "", "d", "_16.png", 3, 3};
const FolderLayout kUnnamedFolders{"a", "", ".png", "b", "", ".png", 3, 3};

TEST(ImageFolder, UsualLayouts) {
  for (const FolderLayout& layout :
       {kTwoFolders, kSevenScenes, kOneFolder, kNumpy, kReplica, kWithSize, kUnnamedFolders}) {
    io::TestDirectory directory;
    write_layout(directory.path(), layout);
    io::write_text(directory / "intrinsics.txt", kMatrix);
    const auto sequence = open_sequence(directory.path());
    ASSERT_TRUE(sequence.ok()) << sequence.error().message;
    EXPECT_EQ((*sequence)->format(), "images");
    EXPECT_EQ((*sequence)->num_views(), 3);
    EXPECT_FALSE((*sequence)->has_poses());
    const auto frame = (*sequence)->read_view(2);
    ASSERT_TRUE(frame.ok()) << frame.error().message;
    EXPECT_EQ(frame->camera, (Camera{kWidth, kHeight, 60, 61, 3.5, 2.5}));
    EXPECT_NEAR(frame->depth_m(1, 1), 1.2, 1e-6);
  }
}

TEST(ImageFolder, SaysWhatIsMissing) {
  io::TestDirectory directory;
  write_layout(directory / "a", kTwoFolders);
  EXPECT_THAT(open_sequence(directory / "a").error().message,
              HasSubstr("found 3 colour and 3 depth images, no intrinsics: give --intrinsics fx,fy,cx,cy or FILE"));
  std::filesystem::remove_all(directory / "a/depth");
  EXPECT_THAT(open_sequence(directory / "a").error().message, HasSubstr("found 3 colour images, but no depth"));
  io::write_text(directory / "a/rgb.mp4", "x");
  EXPECT_THAT(open_sequence(directory / "a").error().message, HasSubstr("rgb.mp4 is a video, which is not read"));
  ASSERT_TRUE(write_color(directory / "a/depth/000000.png", Image<Rgb8>(kWidth, kHeight)).ok());
  EXPECT_THAT(open_sequence(directory / "a").error().message, HasSubstr("pictures of depth, no depth"));
  std::filesystem::remove_all(directory / "a/depth");
  io::write_text(directory / "a/depth/000000.tiff", "x");
  EXPECT_THAT(open_sequence(directory / "a").error().message, HasSubstr(".tiff files, which are not read"));
  write_layout(directory / "b", kTwoFolders);
  io::write_text(directory / "b/camera.yaml", "fx: 60\nfy: 61\ncx: 900\ncy: 2.5\n");
  EXPECT_THAT(open_sequence(directory / "b").error().message, HasSubstr("another image size"));
  io::write_text(directory / "b/camera.yaml", "fx: 60\nfy: 61\ncx: 3\n");
  EXPECT_THAT(open_sequence(directory / "b").error().message, HasSubstr("camera.yaml: holds no intrinsics"));
}

TEST(ImageFolder, FoldersOfWholeSequencesAreNotMixed) {
  io::TestDirectory directory;
  write_layout(directory / "walk_1", kOneFolder);
  write_layout(directory / "walk_2", kOneFolder);
  EXPECT_THAT(open_sequence(directory.path()).error().message, Not(HasSubstr("colour")));
}

TEST(ImageFolder, InfraredIsNotTakenForDepth) {
  for (const char* folder : {"ir", "left_16"}) {
    io::TestDirectory directory;
    write_layout(directory.path(), {"color", "", ".jpg", folder, "", ".png", 6, 3});
    EXPECT_THAT(open_sequence(directory.path()).error().message, HasSubstr("found 3 colour images, but no depth"));
  }
  io::TestDirectory directory;
  write_layout(directory.path(), {"a", "", ".jpg", "ir", "", ".png", 6, 3});
  EXPECT_THAT(open_sequence(directory.path()).error().message, HasSubstr("found 3 colour images, but no depth"));
}

TEST(ImageFolder, OptionsReplaceWhatTheFolderSays) {
  io::TestDirectory directory;
  write_layout(directory.path(), kTwoFolders);
  OpenSequenceOptions options;
  options.intrinsics = "62,63,3,2";
  options.depth_scale_m = 0.0005;
  options.poses = "fixed";
  options.views.every = 2;
  const auto sequence = open_posed_sequence(directory.path(), options);
  ASSERT_TRUE(sequence.ok()) << sequence.error().message;
  ASSERT_EQ((*sequence)->num_views(), 2);
  const auto frame = (*sequence)->read_view(1);
  ASSERT_TRUE(frame.ok()) << frame.error().message;
  EXPECT_EQ(frame->camera.fx, 62);
  EXPECT_NEAR(frame->depth_m(0, 0), 0.6, 1e-6);
  options.depth_bias_per_m = 0.01;
  EXPECT_NEAR((*open_posed_sequence(directory.path(), options))->read_view(1)->depth_m(0, 0), 0.6 / (1 - 0.006), 1e-6);
  options.depth_bias_per_m = 0.06;
  EXPECT_THAT(open_sequence(directory.path(), options).error().message, HasSubstr("--depth-bias 0.06"));
  options.depth_bias_per_m = 0;
  options.views.max_views = 1;
  EXPECT_EQ((*open_posed_sequence(directory.path(), options))->num_views(), 1);
  options.views.max_views = 7;
  EXPECT_EQ((*open_posed_sequence(directory.path(), options))->num_views(), 2);
  options.views.max_views = 0;
  EXPECT_THAT(open_sequence(directory.path(), options).error().message, HasSubstr("--max-views must be at least 1"));
  options.views.max_views.reset();
  options.depth_scale_m = 1;
  EXPECT_THAT(open_sequence(directory.path(), options).error().message, HasSubstr("the unit is wrong"));
}

TEST(ImageFolder, AbsurdDepthIsNoReturn) {
  io::TestDirectory directory;
  Image<float> depth_m(kWidth, kHeight, 2.0F);
  depth_m(3, 2) = 20000;
  ASSERT_TRUE(write_color(directory / "color/0.jpg", Image<Rgb8>(kWidth, kHeight)).ok());
  ASSERT_TRUE(write_depth(directory / "depth/0.png", depth_m, 1).ok());
  io::write_text(directory / "intrinsics.txt", kMatrix);
  OpenSequenceOptions options;
  options.depth_scale_m = 1;
  const auto sequence = open_sequence(directory.path(), options);
  ASSERT_TRUE(sequence.ok()) << sequence.error().message;
  EXPECT_TRUE(std::isnan((*sequence)->read_view(0)->depth_m(3, 2)));
  EXPECT_EQ((*sequence)->read_view(0)->depth_m(2, 3), 2);
}

TEST(ImageFolder, DepthArraysAreMetres) {
  for (const char* extension : {".npz", ".exr"}) {
    io::TestDirectory directory;
    write_layout(directory.path(), kTwoFolders);
    std::filesystem::remove_all(directory / "depth");
    std::filesystem::create_directories(directory / "depth");
    for (int i = 0; i < 3; ++i)
      std::filesystem::copy(
          std::filesystem::path(RESIGHT_SOURCE_DIR) / "tests/data/depth" / ("single" + std::string(extension)),
          directory / "depth" / (numbered(kTwoFolders, i) + extension));
    io::write_text(directory / "intrinsics.txt", kMatrix);
    const auto sequence = open_sequence(directory.path());
    ASSERT_TRUE(sequence.ok()) << sequence.error().message;
    EXPECT_NEAR((*sequence)->read_view(2)->depth_m(2, 1), 1.1, 1e-6);
    EXPECT_THAT((*sequence)->notes(), testing::Contains(HasSubstr("taken as metres")));
  }
}

// Depth of a phone has fewer pixels than its colours, but the same field of view.
TEST(ImageFolder, RegisteredDepthOfLowerResolution) {
  io::TestDirectory directory;
  ASSERT_TRUE(write_color(directory / "color/0.jpg", Image<Rgb8>(2 * kWidth, 2 * kHeight)).ok());
  Image<float> depth_m(kWidth, kHeight, 1.0F);
  depth_m(5, 3) = 2;
  ASSERT_TRUE(write_depth(directory / "depth/0.png", depth_m, 0.001).ok());
  io::write_text(directory / "intrinsics.txt", "60 60 7.5 5.5\n");
  const auto sequence = open_sequence(directory.path());
  ASSERT_TRUE(sequence.ok()) << sequence.error().message;
  EXPECT_THAT((*sequence)->notes(), testing::Contains(HasSubstr("taken as registered")));
  const RgbdFrame frame = (*sequence)->read_view(0).value();
  ASSERT_EQ(frame.depth_m.width(), 2 * kWidth);
  for (int v = 0; v < 2 * kHeight; ++v)
    for (int u = 0; u < 2 * kWidth; ++u)
      EXPECT_EQ(frame.depth_m(u, v), u / 2 == 5 && v / 2 == 3 ? 2 : 1) << u << " " << v;
}

TEST(ImageFolder, DepthOfMuchLowerResolutionHasNoGaps) {
  io::TestDirectory directory;
  ASSERT_TRUE(write_color(directory / "color/0.jpg", Image<Rgb8>(20 * kWidth, 20 * kHeight)).ok());
  ASSERT_TRUE(write_depth(directory / "depth/0.png", Image<float>(kWidth, kHeight, 1.0F), 0.001).ok());
  io::write_text(directory / "intrinsics.txt", "600 600 79.5 59.5\n");
  const auto sequence = open_sequence(directory.path());
  ASSERT_TRUE(sequence.ok()) << sequence.error().message;
  EXPECT_EQ((*sequence)->read_view(0)->depth_m, Image<float>(20 * kWidth, 20 * kHeight, 1.0F));
}

// The streams of a RealSense as they are: nearly the same aspect ratio, but another camera.
TEST(ImageFolder, DepthOfAnotherAspectRatioIsRefused) {
  io::TestDirectory directory;
  ASSERT_TRUE(write_color(directory / "color/0.jpg", Image<Rgb8>(1280, 720)).ok());
  ASSERT_TRUE(write_depth(directory / "depth/0.png", Image<float>(848, 480, 1.0F), 0.001).ok());
  io::write_text(directory / "intrinsics.txt", "900 900 639.5 359.5\n");
  EXPECT_THAT(open_sequence(directory.path()).error().message, HasSubstr("848x480, but its colour image 1280x720"));
}

TEST(ImageFolder, DepthOfACameraBesideIsRegistered) {
  io::TestDirectory directory;
  write_layout(directory.path(), kTwoFolders);
  for (int i = 0; i < 3; ++i)
    ASSERT_TRUE(
        write_depth(directory / "depth" / (numbered(kTwoFolders, i) + ".png"), Image<float>(12, 12, 1.5F), 0.001).ok());
  io::write_text(directory / "intrinsics.txt", kMatrix);
  EXPECT_THAT(open_sequence(directory.path()).error().message,
              HasSubstr("expected depth registered to colour, or --depth-intrinsics and --color-from-depth"));
  // The depth camera looks at the same place from 10 cm (4 px of it) to the left.
  OpenSequenceOptions options;
  options.depth_intrinsics = "60,60,5.5,5.5";
  EXPECT_THAT(open_sequence(directory.path(), options).error().message, HasSubstr("need each other"));
  options.color_from_depth = (directory / "color_from_depth.txt").string();
  io::write_text(options.color_from_depth, "1 0 0 -0.1 0 1 0 0 0 0 1 0\n");
  const auto sequence = open_sequence(directory.path(), options);
  ASSERT_TRUE(sequence.ok()) << sequence.error().message;
  const RgbdFrame frame = (*sequence)->read_view(0).value();
  ASSERT_EQ(frame.depth_m.width(), kWidth);
  EXPECT_NEAR(frame.depth_m(1, 2), 1.5, 1e-6);
  EXPECT_TRUE(std::isnan(frame.depth_m(7, 2))) << "beyond the right border of the depth camera";
  options.depth_intrinsics = "60,60,500,5.5";
  EXPECT_THAT(open_sequence(directory.path(), options).error().message, HasSubstr("--depth-intrinsics: the centre"));
  options.depth_intrinsics = "60,60,5";
  EXPECT_THAT(open_sequence(directory.path(), options).error().message, HasSubstr("--depth-intrinsics: 3 numbers"));
  options.depth_intrinsics = "60,60,5.5,5.5";
  io::write_text(options.color_from_depth, "1 0 0 -100 0 1 0 0 0 0 1 0\n");
  EXPECT_THAT(open_sequence(directory.path(), options).error().message, HasSubstr("100 m apart (expected metres)"));
}

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

// As with --follow, when the first view is there alone.
TEST(ImageFolder, TheNameOfAViewStaysWhenOthersFollow) {
  for (const auto& [first, second] : {std::pair<std::string, std::string>{"cam1_#_0001", "cam1_#_0002"},
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

TEST(ImageFolder, SinglePairsOfTimesAreComparedByTime) {
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
