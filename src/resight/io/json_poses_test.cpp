// SPDX-License-Identifier: Apache-2.0
#include "resight/io/internal/json_poses.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "resight/io/images.hpp"
#include "resight/io/internal/test_data.hpp"

namespace resight {
namespace {

using testing::Contains;
using testing::HasSubstr;

constexpr int kNumColumns = 8;
constexpr int kNumRows = 6;
constexpr int kViews = 3;

/// The true poses, camera y down.
std::vector<Rigid3> make_poses() {
  Rng rng(7);
  std::vector<Rigid3> poses;
  for (int i = 0; i < kViews; ++i) poses.push_back(io::random_pose(rng));
  return poses;
}

/// As in the files: camera y up, looking along -z.
Eigen::Matrix4d in_file(const Rigid3& world_from_camera) {
  return world_from_camera.matrix() * Eigen::Vector4d(1, -1, -1, 1).asDiagonal();
}

nlohmann::json rows(const Eigen::MatrixXd& matrix) {
  nlohmann::json rows = nlohmann::json::array();
  for (const auto& row : matrix.rowwise()) rows.push_back(std::vector<double>(row.begin(), row.end()));
  return rows;
}

std::vector<double> flat(const Eigen::MatrixXd& matrix) {
  std::vector<double> numbers;
  for (const auto& row : matrix.rowwise()) numbers.insert(numbers.end(), row.begin(), row.end());
  return numbers;
}

void write_image_pair(const std::filesystem::path& color, const std::filesystem::path& depth) {
  ASSERT_TRUE(write_color(color, Image<Rgb8>(kNumColumns, kNumRows, Rgb8{90, 120, 200})).ok());
  ASSERT_TRUE(write_depth(depth, Image<float>(kNumColumns, kNumRows, 1.5F), 0.001).ok());
}

void expect_poses(const std::filesystem::path& folder, const std::vector<Rigid3>& poses,
                  const OpenSequenceOptions& options = {}) {
  const auto sequence = open_posed_sequence(folder, options);
  ASSERT_TRUE(sequence.ok()) << sequence.error().message;
  ASSERT_EQ((*sequence)->num_views(), static_cast<int>(poses.size()));
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const Eigen::Matrix4d difference = (*sequence)->read_pose(static_cast<int>(i))->matrix() - poses[i].matrix();
    EXPECT_LT(difference.cwiseAbs().maxCoeff(), 1e-9) << "view " << i;
  }
}

/// nerfstudio: frames in any order.
void write_nerfstudio(const std::filesystem::path& folder, const std::vector<Rigid3>& poses, bool per_frame) {
  const nlohmann::json intrinsics = {{"fl_x", 60.0}, {"fl_y", 61.0}, {"cx", 3.5}, {"cy", 2.5}};
  nlohmann::json content = {{"camera_model", "OPENCV"}};
  if (!per_frame) content.update(intrinsics);
  for (const int i : {2, 0, 1}) {
    const std::string stem = fmt::format("frame_{:05d}", i + 1);
    write_image_pair(folder / "images" / (stem + ".jpg"), folder / "depths" / (stem + ".png"));
    nlohmann::json frame = {{"file_path", "images/" + stem + ".jpg"},
                            {"transform_matrix", rows(in_file(poses[static_cast<std::size_t>(i)]))}};
    if (per_frame) frame.update(intrinsics);
    if (per_frame) frame["fl_x"] = 60 + i;
    content["frames"].push_back(frame);
  }
  io::write_text(folder / "transforms.json", content.dump());
}

TEST(JsonPoses, FramesOfNerfstudio) {
  const io::TestDirectory directory;
  const auto poses = make_poses();
  write_nerfstudio(directory.path(), poses, false);
  expect_poses(directory.path(), poses);
  OpenSequenceOptions options;
  options.pose_convention = PoseConvention::kOpenGl;
  expect_poses(directory.path(), poses, options);  // As the file has it anyway.
  options.pose_convention = PoseConvention::kWorldToCamera;
  EXPECT_THAT(open_sequence(directory.path(), options).error().message, HasSubstr("does not apply"));
}

TEST(JsonPoses, InstantNgpHasItsOwnWordsForUnitAndLens) {
  const io::TestDirectory directory;
  write_nerfstudio(directory.path(), make_poses(), false);
  const std::string before = io::read_text(directory / "transforms.json");
  const auto with = [&](const nlohmann::json& values) {
    auto content = nlohmann::json::parse(before);
    content.update(values);
    io::write_text(directory / "transforms.json", content.dump());
    return io::read_calibration(directory / "transforms.json");
  };
  EXPECT_EQ(with({{"scale", 0.5}, {"aabb_scale", 16}})->metres_per_unit, std::nullopt) << "the size of the scene";
  EXPECT_EQ(with({{"scale", 0.5}, {"integer_depth_scale", 0.02}})->metres_per_unit, 0.02);
  ASSERT_TRUE(with({{"integer_depth_scale", 0.0008}}).ok());
  const auto sequence = open_sequence(directory.path());
  ASSERT_TRUE(sequence.ok()) << sequence.error().message;
  EXPECT_NEAR((*sequence)->read_view(0)->depth_m(0, 0), 1.2, 1e-6);
  const nlohmann::json coefficients = {{"k1", 0.1}, {"k2", 0.02}, {"k3", 0.003}, {"k4", 0.0004}, {"p1", 0}, {"p2", 0}};
  for (const bool is_fisheye : {true, false}) {
    auto values = coefficients;
    values["is_fisheye"] = is_fisheye;
    const auto lens = LensDistortion::make("equidistant", std::vector<double>{0.1, 0.02, 0.003, 0.0004});
    EXPECT_EQ(with(values)->lens == *lens, is_fisheye);
  }
}

TEST(JsonPoses, AreGivenByName) {
  const io::TestDirectory directory;
  const auto poses = make_poses();
  write_nerfstudio(directory / "scan", poses, false);
  std::filesystem::rename(directory / "scan" / "transforms.json", directory / "given.json");
  OpenSequenceOptions options;
  options.intrinsics = "60,61,3.5,2.5";
  EXPECT_FALSE((*open_sequence(directory / "scan", options))->has_poses());
  options.poses = (directory / "given.json").string();
  expect_poses(directory / "scan", poses, options);
}

TEST(JsonPoses, IntrinsicsOfEachFrame) {
  const io::TestDirectory directory;
  write_nerfstudio(directory.path(), make_poses(), true);
  const auto sequence = open_sequence(directory.path());
  ASSERT_TRUE(sequence.ok()) << sequence.error().message;
  for (int i = 0; i < kViews; ++i)
    EXPECT_EQ((*sequence)->read_view(i)->camera, (Camera{kNumColumns, kNumRows, 60.0 + i, 61, 3.5, 2.5}));
}

TEST(JsonPoses, LensAndImageSizeOfEachFrame) {
  const io::TestDirectory directory;
  write_nerfstudio(directory.path(), make_poses(), true);
  const auto change = [&](std::size_t frame, const nlohmann::json& values) {
    auto content = nlohmann::json::parse(io::read_text(directory / "transforms.json"));
    content["frames"][frame].update(values);  // Of view 2, 0, 1.
    io::write_text(directory / "transforms.json", content.dump());
  };
  // The outermost pixels see what lies outside the image without distortion.
  const auto num_missing = [&](int view, const OpenSequenceOptions& options) {
    const auto sequence = open_sequence(directory.path(), options);
    EXPECT_TRUE(sequence.ok()) << sequence.error().message;
    return std::ranges::count_if((*sequence)->read_view(view)->depth_m.data(), [](float z) { return std::isnan(z); });
  };
  change(0, {{"k1", 40}, {"k2", 0}, {"p1", 0}, {"p2", 0}});
  EXPECT_EQ(num_missing(0, {}), 0);
  EXPECT_GT(num_missing(2, {}), 0);
  OpenSequenceOptions options;
  options.intrinsics = "60,61,3.5,2.5";
  EXPECT_EQ(num_missing(2, options), 0) << "given intrinsics are those of all views";
  change(0, {{"w", 2 * kNumColumns}, {"h", 2 * kNumRows}});
  const auto sequence = open_sequence(directory.path());
  ASSERT_TRUE(sequence.ok()) << sequence.error().message;
  EXPECT_TRUE((*sequence)->read_view(1).ok());
  EXPECT_THAT((*sequence)->read_view(2).error().message, HasSubstr("are for images of 16x12, but these have 8x6"));
  EXPECT_EQ(num_missing(2, options), 0);
}

TEST(JsonPoses, Record3d) {
  const io::TestDirectory directory;
  const auto poses = make_poses();
  nlohmann::json content = {{"K", {60, 0, 0, 0, 61, 0, 3.5, 2.5, 1}}, {"fps", 60}};
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const std::string stem = std::to_string(i);
    write_image_pair(directory / "rgb" / (stem + ".jpg"), directory / "depth" / (stem + ".png"));
    const Rigid3 pose = Rigid3::from_matrix(in_file(poses[i]));
    const Eigen::Quaterniond q(pose.rotation);
    const Eigen::Vector3d& t = pose.translation;
    content["poses"].push_back({q.x(), q.y(), q.z(), q.w(), t.x(), t.y(), t.z()});
  }
  io::write_text(directory / "metadata.json", content.dump());
  expect_poses(directory.path(), poses);
  content["poses"].erase(2);
  io::write_text(directory / "metadata.json", content.dump());
  EXPECT_THAT(open_sequence(directory.path()).error().message, HasSubstr("holds 2 poses without stamps for 3 views"));
  content["poses"] = {{1, 2, 3}};
  io::write_text(directory / "metadata.json", content.dump());
  EXPECT_THAT(open_sequence(directory.path()).error().message, HasSubstr("expected 7 numbers"));
}

TEST(JsonPoses, AFileForEachView) {
  const auto poses = make_poses();
  for (const bool is_polycam : {true, false}) {
    const io::TestDirectory directory;
    for (std::size_t i = 0; i < poses.size(); ++i) {
      const std::string number = fmt::format("{:05d}", i);
      const Eigen::Matrix4d matrix = in_file(poses[i]);
      nlohmann::json content;
      if (is_polycam) {
        content = {{"fx", 60.0 + static_cast<double>(i)}, {"fy", 61}, {"cx", 3.5}, {"cy", 2.5}, {"blur_score", 100}};
        for (int k = 0; k < 12; ++k) content[fmt::format("t_{}{}", k / 4, k % 4)] = matrix(k / 4, k % 4);
        write_image_pair(directory / "images" / (number + ".jpg"), directory / "depth" / (number + ".png"));
        io::write_text(directory / "cameras" / (number + ".json"), content.dump());
      } else {
        content = {{"intrinsics", {60.0 + static_cast<double>(i), 0, 3.5, 0, 61, 2.5, 0, 0, 1}},
                   {"cameraPoseARFrame", flat(matrix)}};
        write_image_pair(directory / ("frame_" + number + ".jpg"), directory / ("depth_" + number + ".png"));
        io::write_text(directory / ("frame_" + number + ".json"), content.dump());
      }
    }
    expect_poses(directory.path(), poses);
    const auto sequence = open_sequence(directory.path());
    EXPECT_THAT((*sequence)->notes(), Contains(HasSubstr("intrinsics of each view")));
    EXPECT_EQ((*sequence)->read_view(2)->camera, (Camera{kNumColumns, kNumRows, 62, 61, 3.5, 2.5}));
  }
}

TEST(JsonPoses, OtherContentIsNoPose) {
  const io::TestDirectory directory;
  write_image_pair(directory / "rgb" / "0.jpg", directory / "depth" / "0.png");
  write_image_pair(directory / "rgb" / "1.jpg", directory / "depth" / "1.png");
  io::write_text(directory / "intrinsics.txt", "60 0 3.5\n0 61 2.5\n0 0 1\n");
  io::write_text(directory / "metadata.json", R"({"poses": "none", "fps": 30})");
  const auto sequence = open_sequence(directory.path());
  ASSERT_TRUE(sequence.ok()) << sequence.error().message;
  EXPECT_FALSE((*sequence)->has_poses());
  io::write_text(directory / "transforms.json", R"({"frames": [{"file_path": "rgb/0.jpg", "transform_matrix": [1]}]})");
  EXPECT_THAT(open_sequence(directory.path()).error().message, HasSubstr("expected a pose of 12 or 16 numbers"));
}

TEST(JsonPoses, DamagedFilesAreErrors) {
  const io::TestDirectory directory;
  const auto poses = make_poses();
  write_nerfstudio(directory.path(), poses, true);
  const std::string good = io::read_text(directory / "transforms.json");
  Rng rng(3);
  for (int i = 0; i < 300; ++i) {
    std::string text = good;
    for (int k = 0; k < 3; ++k)
      text[rng.below(static_cast<std::uint32_t>(text.size()))] = static_cast<char>(32 + rng.below(95));
    io::write_text(directory / "transforms.json", text);
    const auto list = io::read_json_poses(directory / "transforms.json");
    const auto calibrations = io::read_frame_calibrations(directory / "transforms.json");
    EXPECT_TRUE(list.ok() || !list.error().message.empty());
    EXPECT_TRUE(calibrations.ok() || !calibrations.error().message.empty());
  }
}

}  // namespace
}  // namespace resight
