// SPDX-License-Identifier: Apache-2.0
#include "resight/io/internal/calibration.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include "resight/io/internal/test_data.hpp"

namespace resight {
namespace {

using testing::HasSubstr;

const std::string kCameraMatrix = "60 0 3.5\n0 61 2.5\n0 0 1\n";

TEST(Calibration, UsualForms) {
  io::TestDirectory directory;
  const auto read = [&](const std::string& name, const std::string& text) {
    io::write_text(directory / name, text);
    return io::read_calibration(directory / name);
  };
  const std::vector<std::pair<std::string, std::string>> forms = {
      {"k.txt", kCameraMatrix},
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
      {"k.ini", "[camera]\nfx = 60\nfy = 61\ncx = 3.5\ncy = 2.5\n"},
      {"k.txt", "fx 60\nfy 61\ncx 3.5\ncy 2.5\n"},
      {"k.txt", "60, 61\n3.5, 2.5\n"},
      {"k.txt", "[60; 61\n3.5; 2.5]\n"},
      {"k.yaml", "image_width: 8\nk:\n- 60.0\n- 0.0\n- 3.5\n- 0.0\n- 61.0\n- 2.5\n- 0.0\n- 0.0\n- 1.0\nd: [0, 0]\n"},
      {"scene0000_00.txt", "fx_color = 60\nfx_depth = 9\nfy_color = 61\nmx_color = 3.5\nmy_color = 2.5\n"},
      // To COLMAP, the centre of the first pixel is at (0.5, 0.5).
      {"cameras.txt", "# Camera list\n1 PINHOLE 8 6 60 61 4 3\n2 PINHOLE 8 6 60 61 4 3\n"},
      {"scene0000_00.txt",
       "m_colorWidth = 8\nm_calibrationColorIntrinsic = 60 0 3.5 0 0 61 2.5 0 0 0 1 0 0 0 0 1\n"
       "m_calibrationDepthIntrinsic = 9 0 1 0 0 9 1 0 0 0 1 0 0 0 0 1\n"}};
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
  // Each of these words means the same lens; the names of the coefficients alone would mean another one.
  const auto fisheye = LensDistortion::make("equidistant", std::vector<double>{0.1, 0.01, 0.02, 0.03});
  for (const auto& [name, model] : {std::pair{"f.json", R"("camera_model": "OPENCV_FISHEYE", )"},
                                    {"f.json", R"("model": "fisheye", )"},
                                    {"f.yaml", "Camera.type: \"KannalaBrandt8\"\n"},
                                    {"f.yaml", "distortion_model: equidistant\n"}}) {
    const bool is_json = std::string_view(name) == "f.json";
    const std::string text =
        is_json ? fmt::format(R"({{{} "fx": 60, "fy": 61, "cx": 3.5, "cy": 2.5, "k1": 0.1, "k2": 0.01, "k3": 0.02,
                                  "k4": 0.03}})",
                              model)
                : fmt::format("{}fx: 60\nfy: 61\ncx: 3.5\ncy: 2.5\nk1: 0.1\nk2: 0.01\nk3: 0.02\nk4: 0.03\n", model);
    const auto bent = read(name, text);
    ASSERT_TRUE(bent.ok()) << bent.error().message;
    EXPECT_EQ(bent->lens, *fisheye) << model;
  }
  const auto opencv = read("cameras.txt", "1 OPENCV 8 6 60 61 3.5 2.5 0.1 0.01 0 0\n");
  ASSERT_TRUE(opencv.ok()) << opencv.error().message;
  EXPECT_EQ(opencv->lens, *LensDistortion::make("plumb_bob", std::vector<double>{0.1, 0.01, 0, 0}));
  EXPECT_EQ(opencv->width, 8);
  EXPECT_EQ(read("cameras.txt", "1 SIMPLE_RADIAL 8 6 60 4 3 0.1\n")->intrinsics, (io::Intrinsics{60, 60, 3.5, 2.5}));
  EXPECT_THAT(read("cameras.txt", "1 PINHOLE 8 6 60 61 3.5\n").error().message, HasSubstr("'PINHOLE' has 5 numbers"));
  EXPECT_THAT(read("cameras.txt", "1 PINHOLE 8 6 60 61 3.5 2.5\n2 PINHOLE 8 6 70 71 3.5 2.5\n").error().message,
              HasSubstr("several cameras"));
  EXPECT_THAT(read("bad.txt", "1 2 3\n").error().message, HasSubstr("3 numbers"));
  EXPECT_THAT(
      read("bad.json", R"({"a": {"fx": 1, "fy": 1, "cx": 1, "cy": 1}, "b": {"fx": 2, "fy": 2, "cx": 1, "cy": 1}})")
          .error()
          .message,
      HasSubstr("several cameras"));
}

TEST(Calibration, OfSeveralCamerasThatOfTheColours) {
  io::TestDirectory directory;
  const auto read = [&](const std::string& name, const std::string& text) {
    io::write_text(directory / name, text);
    return io::read_calibration(directory / name);
  };
  const std::string depth = "fx: 50\n  fy: 50\n  cx: 3\n  cy: 2\n";
  const std::string color = "fx: 60\n  fy: 61\n  cx: 3.5\n  cy: 2.5\n";
  for (const auto& [name, text] : std::vector<std::pair<std::string, std::string>>{
           {"k.yaml", "depth:\n  " + depth + "color:\n  " + color},
           {"k.yaml", "cameras:\n  depth: {fx: 50, fy: 50, cx: 3, cy: 2}\n  rgb: {fx: 60, fy: 61, cx: 3.5, cy: 2.5}\n"},
           {"k.yaml",
            "Depth.fx: 50\nDepth.fy: 50\nDepth.cx: 3\nDepth.cy: 2\nRgb.fx: 60\nRgb.fy: 61\nRgb.cx: 3.5\n"
            "Rgb.cy: 2.5\n"},
           {"k.yaml",
            "depth:\n  camera_matrix:\n    rows: 3\n    data: [50, 0, 3,\n      0, 50, 2, 0, 0, 1]\n"
            "color:\n  camera_matrix:\n    rows: 3\n    data: [60, 0, 3.5,\n      0, 61, 2.5, 0, 0, 1]\n"},
           {"k.ini", "[depth]\nfx = 50\nfy = 50\ncx = 3\ncy = 2\n[color]\nfx = 60\nfy = 61\ncx = 3.5\ncy = 2.5\n"}}) {
    const auto calibration = read(name, text);
    ASSERT_TRUE(calibration.ok()) << calibration.error().message << "\n" << text;
    EXPECT_EQ(calibration->intrinsics, (io::Intrinsics{60, 61, 3.5, 2.5})) << text;
  }
  EXPECT_THAT(read("k.yaml", "cam0:\n  " + depth + "cam1:\n  " + color).error().message,
              HasSubstr("several cameras (cam0, cam1)"));
  const auto with_unit = read("k.yaml", "camera:\n  " + color + "depth_scale: 0.0002\n");
  ASSERT_TRUE(with_unit.ok()) << with_unit.error().message;
  EXPECT_EQ(with_unit->metres_per_unit, 0.0002);
}

TEST(Calibration, FilesOfAFolderCompleteEachOther) {
  io::TestDirectory directory;
  const std::string matrix = "fx: 60\nfy: 61\ncx: 3.5\ncy: 2.5\n";
  const auto find = [&](const std::string& a, const std::string& b, std::filesystem::path& source) {
    io::write_text(directory / "camera_a.yaml", matrix + a);
    io::write_text(directory / "camera_b.yaml", matrix + b);
    return io::find_calibration(directory.path(), source);
  };
  std::filesystem::path source;
  const auto found = find("width: 8\n", "k1: -0.3\nk2: 0\np1: 0\np2: 0\ndepth_scale: 0.0002\n", source);
  ASSERT_TRUE(found.ok() && found->has_value());
  EXPECT_EQ((*found)->width, 8);
  EXPECT_FALSE((*found)->lens.is_none());
  EXPECT_EQ((*found)->metres_per_unit, 0.0002);
  EXPECT_EQ(source.filename(), "camera_a.yaml, camera_b.yaml");
  ASSERT_TRUE(find("", "", source).ok());
  EXPECT_EQ(source.filename(), "camera_a.yaml");
  for (const auto& [a, b] : {std::pair("depth_scale: 0.001\n", "depth_scale: 0.0002\n"),
                             {"width: 8\n", "width: 16\n"},
                             {"k1: -0.3\nk2: 0\np1: 0\np2: 0\n", "k1: 0.3\nk2: 0\np1: 0\np2: 0\n"}})
    EXPECT_THAT(find(a, b, source).error().message, HasSubstr("camera_a.yaml and camera_b.yaml hold different"));
}

// Names that lie around others become part of these.
TEST(Calibration, ALongNameAroundManyTakesLittleMemory) {
  std::string text = std::string(500'000, 'a') + ":\n";
  for (int i = 0; i < 80'000; ++i) text += "  b:1\n";
  const io::TestDirectory directory;
  io::write_text(directory / "camera.yaml", text);
  EXPECT_FALSE(io::read_calibration(directory / "camera.yaml").ok());
}

TEST(Calibration, OptionsMayHaveBlanks) {
  const auto calibration = io::parse_calibration("60,61,3.5, 2.5");
  ASSERT_TRUE(calibration.ok()) << calibration.error().message;
  EXPECT_EQ(calibration->intrinsics, (io::Intrinsics{60, 61, 3.5, 2.5}));
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
