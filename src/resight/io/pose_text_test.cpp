// SPDX-License-Identifier: Apache-2.0
#include "resight/io/pose_text.hpp"

#include <gmock/gmock.h>

#include <cmath>

#include "resight/io/internal/files.hpp"
#include "resight/io/internal/test_data.hpp"
#include "resight/io/internal/text.hpp"

namespace resight {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

TEST(PoseText, ComesBackBitByBit) {
  Rng rng(1);
  for (int i = 0; i < 50; ++i) {
    const Rigid3 pose = io::random_pose(rng);
    const auto back = parse_pose(format_pose(pose), "test");
    ASSERT_TRUE(back.ok()) << back.error().message;
    EXPECT_EQ(back->rotation, pose.rotation);
    EXPECT_EQ(back->translation, pose.translation);
  }
}

TEST(PoseText, FewDigitsAreRepaired) {
  const auto pose = parse_pose("label 0.87 -0.5 0 1\n0.5 0.87 0 2\n0 0 1 3\n0 0 0 1", "test");
  ASSERT_TRUE(pose.ok()) << pose.error().message;
  EXPECT_TRUE(pose->is_rigid(1e-12));
  EXPECT_NEAR(pose->rotation(0, 1), -0.5, 0.01);
  EXPECT_EQ(pose->translation, Eigen::Vector3d(1, 2, 3));
}

TEST(PoseText, BadPoses) {
  const auto message = [](const std::string& text) {
    const auto pose = parse_pose(text, "p.txt");
    return pose.ok() ? std::string("no error") : pose.error().message;
  };
  EXPECT_THAT(message("1 0 0"), HasSubstr("16 numbers"));
  EXPECT_THAT(message(""), HasSubstr("16 numbers"));
  EXPECT_THAT(message("1 0 0 0 0 1 0 0 0 0 1 x 0 0 0 1"), HasSubstr("16 numbers"));
  EXPECT_THAT(message("2 0 0 0 0 2 0 0 0 0 2 0 0 0 0 1"), HasSubstr("rigid"));
  EXPECT_THAT(message("1 0 0 0 0 1 0 0 0 0 -1 0 0 0 0 1"), HasSubstr("reflection"));
  EXPECT_THAT(message("1 0 0 nan 0 1 0 0 0 0 1 0 0 0 0 1"), HasSubstr("NaN"));
  EXPECT_THAT(message("1 0 0 0 0 1 0 0 0 0 1 0 5 5 5 1"), HasSubstr("last row"));
  EXPECT_THAT(message("1 0 0 1e300 0 1 0 0 0 0 1 0 0 0 0 1"), HasSubstr("more than 10000 m away from the origin"));
  EXPECT_THAT(rigid_from_quaternion({1, 0, 0, 0}, {0, -1e300, 0}, "p").error().message, HasSubstr("more than 10000 m"));
}

TEST(Text, NaturalOrder) {
  std::vector<std::string> names = {"v_10", "v_9", "v_2", "v_02b", "v_01", "v", "u_99999999999999999999", "u_3"};
  std::ranges::sort(names, io::natural_less);
  EXPECT_THAT(names, ElementsAre("u_3", "u_99999999999999999999", "v", "v_01", "v_2", "v_02b", "v_9", "v_10"));
  for (const auto& a : names)
    for (const auto& b : names)
      EXPECT_EQ(io::natural_less(a, b) + io::natural_less(b, a), a == b ? 0 : 1) << a << " " << b;
}

TEST(Text, Numbers) {
  EXPECT_EQ(io::parse_number("+1.5e2"), 150.0);
  EXPECT_EQ(io::parse_number("1e-999"), 0.0);
  EXPECT_FALSE(io::parse_number("1e999"));
  EXPECT_FALSE(io::parse_number("1.5x"));
  EXPECT_FALSE(io::parse_number("+-1"));
  EXPECT_TRUE(std::isnan(*io::parse_number("nan")));
  EXPECT_EQ(io::trailing_number("cloud_0012"), 12);
  EXPECT_FALSE(io::trailing_number("cloud"));
  EXPECT_FALSE(io::trailing_number("1305031102775472"));
}

}  // namespace
}  // namespace resight
