// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include "resight/io/images.hpp"
#include "resight/io/internal/calibration.hpp"
#include "resight/io/internal/test_data.hpp"

namespace resight {
namespace {

using testing::HasSubstr;

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

TEST(ImageFolder, UsualLayouts) {
  for (const FolderLayout& layout : {kTwoFolders, kSevenScenes, kOneFolder, kNumpy, kReplica, kWithSize}) {
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
  ASSERT_TRUE(write_color(directory / "a/depth/000000.png", Image<Rgb8>(kWidth, kHeight)).ok());
  EXPECT_THAT(open_sequence(directory / "a").error().message, HasSubstr("pictures of depth, no depth"));
  std::filesystem::remove_all(directory / "a/depth");
  io::write_text(directory / "a/depth/000000.exr", "x");
  EXPECT_THAT(open_sequence(directory / "a").error().message, HasSubstr(".exr files, which are not read"));
  write_layout(directory / "b", kTwoFolders);
  io::write_text(directory / "b/camera.yaml", "fx: 60\nfy: 61\ncx: 900\ncy: 2.5\n");
  EXPECT_THAT(open_sequence(directory / "b").error().message, HasSubstr("another image size"));
  io::write_text(directory / "b/camera.yaml", "fx: 60\nfy: 61\ncx: 3\n");
  EXPECT_THAT(open_sequence(directory / "b").error().message, HasSubstr("camera.yaml: holds no intrinsics"));
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
  options.depth_scale_m = 1;
  EXPECT_THAT(open_sequence(directory.path(), options).error().message, HasSubstr("the unit is wrong"));
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
  io::write_text(directory / "given", rows16);
  EXPECT_THAT(open_sequence(directory.path(), options).error().message,
              HasSubstr("1 poses without stamps for 3 views"));
  io::write_text(directory / "given", "1 2 3\n");
  EXPECT_THAT(open_sequence(directory.path(), options).error().message, HasSubstr("line 1"));
}

TEST(Calibration, UsualForms) {
  io::TestDirectory directory;
  const auto read = [&](const std::string& name, const std::string& text) {
    io::write_text(directory / name, text);
    return io::read_calibration(directory / name);
  };
  const std::vector<std::pair<std::string, std::string>> forms = {
      {"k.txt", kMatrix},
      {"k.txt", "60 61 3.5 2.5\n"},
      {"k.csv", "60,0,3.5\n0,61,2.5\n0,0,1\n"},
      {"k.txt", "60 0 3.5 0\n0 61 2.5 0\n0 0 1 0\n0 0 0 1\n"},
      {"k.json", R"({"width": 8, "height": 6, "intrinsic_matrix": [60, 0, 0, 0, 61, 0, 3.5, 2.5, 1]})"},
      {"k.json", R"({"fx": 60, "fy": 61, "ppx": 3.5, "ppy": 2.5, "depth_scale": 0.001})"},
      {"k.json", R"({"camera": {"w": 8, "h": 6, "fx": 60, "fy": 61, "cx": 3.5, "cy": 2.5, "scale": 6553.5}})"},
      {"k.json",
       R"({"depth": {"K": [[1, 0, 1], [0, 1, 1], [0, 0, 1]]}, "color": {"K": [[60, 0, 3.5], [0, 61, 2.5], [0, 0, 1]]}})"},
      {"k.yaml",
       "image_width: 8\nimage_height: 6\ncamera_matrix:\n  rows: 3\n  cols: 3\n  data: [60, 0, 3.5, 0, 61,\n    "
       "2.5, 0, 0, 1]\ndistortion_model: plumb_bob\ndistortion_coefficients:\n  rows: 1\n  cols: 5\n  data: [0, "
       "0, 0, 0, 0]\n"},
      {"k.yaml", "%YAML:1.0\nCamera.fx: 60.0\nCamera.fy: 61.0\nCamera.cx: 3.5\nCamera.cy: 2.5\nCamera.k1: 0.0\n"},
      {"k.ini", "[camera]\nfx = 60\nfy = 61\ncx = 3.5\ncy = 2.5\n"}};
  for (const auto& [name, text] : forms) {
    const auto calibration = read(name, text);
    ASSERT_TRUE(calibration.ok()) << calibration.error().message << "\n" << text;
    EXPECT_EQ(calibration->intrinsics, (io::Intrinsics{60, 61, 3.5, 2.5})) << text;
    EXPECT_TRUE(calibration->lens.is_none()) << text;
  }
  EXPECT_NEAR(*read("r.json", forms[6].second)->metres_per_unit, 1 / 6553.5, 1e-12);
  const auto distorted = read("d.yaml", "fx: 60\nfy: 61\ncx: 3.5\ncy: 2.5\nk1: 0.1\nk2: 0.01\np1: 0\np2: 0\n");
  ASSERT_TRUE(distorted.ok()) << distorted.error().message;
  EXPECT_FALSE(distorted->lens.is_none());
  EXPECT_THAT(read("bad.txt", "1 2 3\n").error().message, HasSubstr("3 numbers"));
  EXPECT_THAT(
      read("bad.json", R"({"a": {"fx": 1, "fy": 1, "cx": 1, "cy": 1}, "b": {"fx": 2, "fy": 2, "cx": 1, "cy": 1}})")
          .error()
          .message,
      HasSubstr("several cameras"));
}

TEST(Calibration, SurvivesDamage) {
  io::TestDirectory directory;
  Rng rng(4);
  for (const std::string& form :
       {std::string(R"({"camera": {"w": 8, "fx": 60, "fy": 61, "cx": [3, 4], "cy": 2.5, "K": {"data": [1]}}})"),
        std::string("camera_matrix: !!opencv-matrix\n rows: 3\n data: [60, 0, 3.5, 0, 61, 2.5, 0, 0, 1]\nd: [1]\n")})
    for (int i = 0; i < 300; ++i) {
      std::string text = form.substr(0, 1 + rng.below(static_cast<std::uint32_t>(form.size())));
      text[rng.below(static_cast<std::uint32_t>(text.size()))] = static_cast<char>(rng.below(256));
      const auto file = directory / (form[0] == '{' ? "k.json" : "k.yaml");
      io::write_text(file, text);
      const auto calibration = io::read_calibration(file);
      EXPECT_TRUE(calibration.ok() || !calibration.error().message.empty());
    }
}

}  // namespace
}  // namespace resight
