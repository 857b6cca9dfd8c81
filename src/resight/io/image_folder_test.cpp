// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <cmath>

#include "resight/io/image_folder_test_util.hpp"

namespace resight {
namespace {

using namespace test;
using testing::HasSubstr;
using testing::Not;

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
  options.views.every = 0;
  EXPECT_THAT(open_sequence(directory.path(), options).error().message, HasSubstr("--every must be at least 1"));
  options.views.every = 2;
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

}  // namespace
}  // namespace resight
