// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <unistd.h>

#include "resight/io/images.hpp"
#include "resight/io/internal/test_data.hpp"
#include "resight/io/trajectory.hpp"

namespace resight {
namespace {

using testing::Contains;
using testing::HasSubstr;

/// Without intrinsics.
void write_recording(const std::filesystem::path& directory, int width = 4, int height = 3) {
  std::string rgb = "# colour\n";
  std::string depth = "# depth\n";
  for (int i = 0; i < 4; ++i) {
    const std::string c = std::to_string(10 + i) + ".500";
    const std::string d = std::to_string(10 + i) + ".510";
    ASSERT_TRUE(write_color(directory / "rgb" / (c + ".png"), Image<Rgb8>(width, height)).ok());
    ASSERT_TRUE(write_depth(directory / "depth" / (d + ".png"), Image<float>(width, height, 1.25F), 1.0 / 5000).ok());
    rgb += c + " rgb/" + c + ".png\n";
    if (i != 2) depth += d + " depth/" + d + ".png\n";
  }
  io::write_text(directory / "rgb.txt", rgb);
  io::write_text(directory / "depth.txt", depth);
}

TEST(Trajectory, IsReadBackDigitByDigit) {
  io::TestDirectory directory;
  write_recording(directory.path());
  io::write_text(directory / "camera.txt", "500 501 2 1\n");
  std::vector<TrajectoryPose> poses;
  for (int v = 0; v < 12; ++v)
    poses.push_back({std::to_string(10 + 0.5 * v),
                     {Rigid3::from_axis_angle({1, 2, 0.1 * v}, 0.3 * v).rotation, {0.1, -2.0 / 3, 1e-7 * v}}});
  ASSERT_TRUE(write_tum_trajectory(directory / "groundtruth.txt", poses, "two\nlines").ok());
  const auto sequence = open_sequence(directory.path());
  ASSERT_TRUE(sequence.ok()) << sequence.error().message;
  EXPECT_TRUE((*sequence)->has_poses());
  EXPECT_NEAR((*sequence)->read_view(0)->world_from_camera.translation.y(), -2.0 / 3, 1e-12);
}

TEST(Trajectory, BelongsToViewsOfAnyName) {
  for (const char* begin : {"my view ", " ", "a,b", "#", "a\n", "50% ", "50%20", "%"}) {
    io::TestDirectory directory;
    std::vector<TrajectoryPose> poses;
    for (int v = 0; v < 3; ++v) {
      const std::string name = begin + std::to_string(v);
      ASSERT_TRUE(write_color(directory / "rgb" / (name + ".png"), Image<Rgb8>(4, 3)).ok());
      ASSERT_TRUE(write_depth(directory / "depth" / (name + ".png"), Image<float>(4, 3, 1.25F), 0.001).ok());
      poses.push_back({name, Rigid3::from_translation({1.0 * v, 0, 0})});
    }
    std::swap(poses[0], poses[2]);  // They do not belong to the views by their order.
    io::write_text(directory / "intrinsics.txt", "5 5 2 1\n");
    ASSERT_TRUE(write_tum_trajectory(directory / "tracked.txt", poses, "").ok());
    OpenSequenceOptions options;
    options.poses = (directory / "tracked.txt").string();
    const auto sequence = open_sequence(directory.path(), options);
    ASSERT_TRUE(sequence.ok()) << begin << ": " << sequence.error().message;
    ASSERT_EQ((*sequence)->num_views(), 3) << begin;
    for (int v = 0; v < 3; ++v) EXPECT_EQ((*sequence)->read_pose(v)->translation.x(), v) << begin;
  }
}

TEST(Tum, AssociatesAndInterpolates) {
  io::TestDirectory directory;
  write_recording(directory.path());
  io::write_text(directory / "camera.txt", "500 501 2 1\n");
  const auto without = open_sequence(directory.path());
  ASSERT_TRUE(without.ok()) << without.error().message;
  EXPECT_EQ((*without)->num_views(), 3) << "the third colour image has no depth";
  EXPECT_FALSE((*without)->has_poses());
  // Half-way between the identity and a rotation of 0.2 rad about z. The view at 13.51 has no pose near it.
  io::write_text(directory / "groundtruth.txt",
                 "# t tx ty tz qx qy qz qw\n10.500 0 0 0 0 0 0 1\n10.520 1 2 4 0 0 0.0998334166 0.9950041653\n11.515 5 "
                 "5 5 0 0 0 1\n");
  const auto sequence = open_sequence(directory.path());
  ASSERT_TRUE(sequence.ok()) << sequence.error().message;
  ASSERT_EQ((*sequence)->num_views(), 2);
  EXPECT_THAT((*sequence)->notes(), Contains("1 of 3 views have no pose near in time and are left out"));
  std::filesystem::rename(directory / "groundtruth.txt", directory / "livingRoom0n.gt.freiburg");
  EXPECT_EQ((*open_sequence(directory.path()))->num_views(), 2) << "the name of ICL-NUIM";
  const auto frame = (*sequence)->read_view(0);
  ASSERT_TRUE(frame.ok()) << frame.error().message;
  EXPECT_EQ(frame->name, "10.500");
  EXPECT_NEAR(frame->depth_m(0, 0), 1.25, 1e-6);
  EXPECT_LT((frame->world_from_camera.translation - Eigen::Vector3d(0.5, 1, 2)).norm(), 1e-9);
  EXPECT_NEAR(rotation_angle_rad(Eigen::Matrix3d::Identity(), frame->world_from_camera.rotation), 0.1, 1e-9);
  EXPECT_EQ((*sequence)->read_view(1)->world_from_camera.translation, Eigen::Vector3d(5, 5, 5))
      << "must use the nearest pose at the end";
}

TEST(Tum, ListsInAnotherOrderAndWithRepetitions) {
  io::TestDirectory directory;
  write_recording(directory.path());
  io::write_text(directory / "camera.txt", "500 501 2 1\n");
  const auto names = [&] {
    const auto sequence = open_sequence(directory.path());
    std::vector<std::string> all;
    for (int i = 0; sequence.ok() && i < (*sequence)->num_views(); ++i) all.push_back((*sequence)->view_name(i));
    return all;
  };
  const std::vector<std::string> ascending = {"10.500", "11.500", "13.500"};
  for (const char* list : {"rgb.txt", "depth.txt"}) {
    const std::string text = io::read_text(directory / list);
    io::write_text(directory / list, text + text);
  }
  EXPECT_EQ(names(), ascending);
  std::string pairs;
  for (const char* second : {"13", "11", "10", "13"})
    pairs += fmt::format("{0}.500 rgb/{0}.500.png {0}.510 depth/{0}.510.png\n", second);
  io::write_text(directory / "associations.txt", pairs);
  EXPECT_EQ(names(), ascending);
  io::write_text(directory / "associations.txt", "nan rgb/10.500.png 10.510 depth/10.510.png\n");
  EXPECT_THAT(open_sequence(directory.path()).error().message, HasSubstr("associations.txt: line 1"));
}

TEST(Tum, Intrinsics) {
  io::TestDirectory directory;
  write_recording(directory / "rgbd_dataset_freiburg3_long", 640, 480);
  EXPECT_EQ((*open_sequence(directory / "rgbd_dataset_freiburg3_long"))->read_view(0)->camera.fx, 535.4);
  io::write_text(directory / "rgbd_dataset_freiburg3_long/camera.txt", "500 501 2 1\n");
  EXPECT_EQ((*open_sequence(directory / "rgbd_dataset_freiburg3_long"))->read_view(0)->camera,
            (Camera{640, 480, 500, 501, 2, 1}));
  write_recording(directory / "freiburg1", 1280, 960);
  EXPECT_THAT(open_sequence(directory / "freiburg1").error().message,
              HasSubstr("intrinsics are for images of 640x480"));
  io::write_text(directory / "rgbd_dataset_freiburg3_long/camera.txt", "0 501 2 1\n");
  EXPECT_THAT(open_sequence(directory / "rgbd_dataset_freiburg3_long").error().message,
              HasSubstr("camera.txt: the focal"));
  write_recording(directory / "desk");
  EXPECT_THAT(open_sequence(directory / "desk").error().message, HasSubstr("--intrinsics fx,fy,cx,cy"))
      << "must not take the calibration of another camera";
  OpenSequenceOptions options;
  options.intrinsics = "510,511,2,1";
  EXPECT_EQ((*open_sequence(directory / "desk", options))->read_view(0)->camera, (Camera{4, 3, 510, 511, 2, 1}));
}

TEST(Tum, BadLists) {
  io::TestDirectory directory;
  write_recording(directory.path());
  io::write_text(directory / "camera.txt", "500 501 2 1\n");
  io::write_text(directory / "groundtruth.txt", "10.5 0 0 0 0 0 0 7\n");
  EXPECT_THAT(open_sequence(directory.path()).error().message, HasSubstr("not rigid"));
  io::write_text(directory / "groundtruth.txt", "10.5 0 0 0 0 0 0\n");
  EXPECT_THAT(open_sequence(directory.path()).error().message, HasSubstr("line 1"));
  io::write_text(directory / "groundtruth.txt", "99 0 0 0 0 0 0 1\n");
  EXPECT_THAT(open_sequence(directory.path()).error().message, HasSubstr("no image has a pose"));
  io::write_text(directory / "rgb.txt", "x y\n");
  EXPECT_THAT(open_sequence(directory.path()).error().message, HasSubstr("rgb.txt: line 1"));
  for (const char* outside : {"1 ../a.png\n", "1 /tmp/a.png\n", "1 rgb/../../a.png\n"}) {
    io::write_text(directory / "rgb.txt", outside);
    EXPECT_THAT(open_sequence(directory.path()).error().message, HasSubstr("out of the folder")) << outside;
  }
  io::write_text(directory / "associations.txt", "1 rgb/a.png 1 ../a.png\n");
  EXPECT_THAT(open_sequence(directory.path()).error().message, HasSubstr("out of the folder"));
}

TEST(OpenSequence, AFolderWithoutPermissionIsNamed) {
  if (::geteuid() == 0) GTEST_SKIP() << "root may read everything";
  io::TestDirectory directory;
  write_recording(directory.path());
  std::filesystem::permissions(directory / "rgb", std::filesystem::perms::none);
  std::filesystem::remove(directory / "rgb.txt");
  EXPECT_THAT(open_sequence(directory.path()).error().message, HasSubstr("rgb cannot be read (Permission denied)"));
  std::filesystem::permissions(directory / "rgb", std::filesystem::perms::owner_all);
}

TEST(OpenSequence, NothingThere) {
  io::TestDirectory directory;
  EXPECT_THAT(open_sequence(directory / "none").error().message, HasSubstr("no such directory"));
  EXPECT_THAT(open_sequence(directory.path()).error().message, HasSubstr("scene_camera.json"));
}

}  // namespace
}  // namespace resight
