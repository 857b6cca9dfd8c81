// SPDX-License-Identifier: Apache-2.0
#include "resight/io/pcd.hpp"

#include <gmock/gmock.h>

#include <bit>
#include <cmath>
#include <cstdio>
#include <tuple>

#include "resight/io/internal/test_data.hpp"

namespace resight {
namespace {

using testing::HasSubstr;

PcdCloud random_cloud(bool with_normals) {
  Rng rng(7);
  PcdCloud cloud;
  cloud.width = 31;
  cloud.height = 17;
  for (int i = 0; i < cloud.width * cloud.height; ++i) {
    const auto real = [&] { return static_cast<float>(rng.normal()); };
    const bool hole = i % 7 == 3;
    const float nan = std::numeric_limits<float>::quiet_NaN();
    cloud.points.push_back(hole ? Eigen::Vector3f(nan, nan, nan) : Eigen::Vector3f(real(), real(), real()));
    cloud.colors.push_back({static_cast<std::uint8_t>(rng.below(256)), static_cast<std::uint8_t>(i), 200});
    if (with_normals) cloud.normals.push_back(Eigen::Vector3f(real(), real(), real()).normalized());
  }
  cloud.viewpoint = io::random_pose(rng);
  return cloud;
}

bool same_bits(const std::vector<Eigen::Vector3f>& a, const std::vector<Eigen::Vector3f>& b) {
  return a.size() == b.size() && std::ranges::equal(a, b, [](const auto& p, const auto& q) {
           for (int k = 0; k < 3; ++k)
             if (!(p[k] == q[k] || (std::isnan(p[k]) && std::isnan(q[k])))) return false;
           return true;
         });
}

class PcdRoundTrip : public testing::TestWithParam<std::tuple<PcdEncoding, bool>> {};

TEST_P(PcdRoundTrip, KeepsEveryBit) {
  const auto [encoding, with_normals] = GetParam();
  io::TestDirectory directory;
  PcdCloud cloud = random_cloud(with_normals);
  cloud.camera = Camera{31, 17, 525.125, 524.5, 15.1, 8.3};
  ASSERT_TRUE(write_pcd(directory / "cloud.pcd", cloud, encoding).ok());
  const auto read = read_pcd(directory / "cloud.pcd");
  ASSERT_TRUE(read.ok()) << read.error().message;
  EXPECT_EQ(read->width, 31);
  EXPECT_EQ(read->height, 17);
  EXPECT_TRUE(same_bits(read->points, cloud.points));
  EXPECT_TRUE(same_bits(read->normals, cloud.normals));
  EXPECT_EQ(read->colors, cloud.colors);
  ASSERT_TRUE(read->camera.has_value());
  EXPECT_EQ(*read->camera, *cloud.camera);
  EXPECT_LT(io::pose_difference(read->viewpoint, cloud.viewpoint), 1e-14);
  EXPECT_EQ(read_pcd_size(directory / "cloud.pcd")->height, 17);
}

INSTANTIATE_TEST_SUITE_P(Encodings, PcdRoundTrip,
                         testing::Combine(testing::Values(PcdEncoding::kAscii, PcdEncoding::kBinary,
                                                          PcdEncoding::kBinaryCompressed),
                                          testing::Bool()));

TEST(Pcd, AnyOrderSizeTypeAndCountOfFields) {
  const std::string header =
      "# .PCD v.7\nVERSION .7\nFIELDS intensity z hist rgba y _ x\nSIZE 2 8 4 4 4 1 4\nTYPE U F F U F U F\nCOUNT 1 1 3 "
      "1 1 5 1\n"
      "WIDTH 2\nHEIGHT 1\nVIEWPOINT 1 2 3 0 1 0 0\nPOINTS 2\nDATA binary\n";
  std::string body;
  const auto add = [&](auto value) { body.append(reinterpret_cast<const char*>(&value), sizeof(value)); };
  for (int i = 0; i < 2; ++i) {
    add(std::uint16_t{9});
    add(0.25 + i);
    for (int k = 0; k < 3; ++k) add(1.0F);
    add(std::uint32_t{0xFF102030});
    add(2.0F);
    body.append("padd!");
    add(-1.5F);
  }
  const auto cloud = parse_pcd(header + body, "test");
  ASSERT_TRUE(cloud.ok()) << cloud.error().message;
  EXPECT_EQ(cloud->points[1], Eigen::Vector3f(-1.5F, 2.0F, 1.25F));
  EXPECT_EQ(cloud->colors[1], (Rgb8{0x10, 0x20, 0x30}));
  EXPECT_EQ(cloud->viewpoint.translation, Eigen::Vector3d(1, 2, 3));
  EXPECT_NEAR(cloud->viewpoint.rotation(1, 1), -1, 1e-12) << "quaternion order is w x y z";
  EXPECT_FALSE(cloud->camera.has_value());
}

TEST(Pcd, AsciiWithFloatPackedColour) {
  // 0x00102030 as a float is a denormal number. Nine digits restore it.
  const float packed = std::bit_cast<float>(std::uint32_t{0x00102030});
  char digits[40];
  std::snprintf(digits, sizeof(digits), "%.9g", static_cast<double>(packed));
  const std::string head = "FIELDS x y z rgb\nSIZE 4 4 4 4\nTYPE F F F F\nWIDTH 1\nPOINTS 1\nDATA ascii\n";
  const auto cloud = parse_pcd(head + "1 nan +3e0 " + digits, "test");
  ASSERT_TRUE(cloud.ok()) << cloud.error().message;
  EXPECT_EQ(cloud->colors[0], (Rgb8{0x10, 0x20, 0x30}));
  EXPECT_TRUE(std::isnan(cloud->points[0].y()));
  EXPECT_EQ(cloud->points[0].z(), 3.0F);
  EXPECT_EQ(cloud->height, 1);
}

struct BadHeader {
  std::string what;
  std::string text;
  std::string message;
};

class PcdBad : public testing::TestWithParam<BadHeader> {};

TEST_P(PcdBad, OneClearError) {
  const auto cloud = parse_pcd(GetParam().text, "bad.pcd");
  ASSERT_FALSE(cloud.ok());
  EXPECT_THAT(cloud.error().message, HasSubstr("bad.pcd: "));
  EXPECT_THAT(cloud.error().message, HasSubstr(GetParam().message));
  EXPECT_EQ(cloud.error().message.find('\n'), std::string::npos);
}

const std::string kXyz = "FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\n";

INSTANTIATE_TEST_SUITE_P(
    Headers, PcdBad,
    testing::Values(
        BadHeader{"Empty", "", "no DATA line"}, BadHeader{"Foreign", "\x89PNG\r\n\x1a\nxx", "not a PCD"},
        BadHeader{"HugeWidth", kXyz + "WIDTH 2147483647\nHEIGHT 2147483647\nDATA binary\nabc", "cut off"},
        BadHeader{"HugeAscii", kXyz + "WIDTH 2000000000\nHEIGHT 1\nDATA ascii\n1 2 3\n", "cut off"},
        BadHeader{"TooManyDigits", kXyz + "WIDTH 99999999999999999999\nDATA ascii\n", "WIDTH"},
        BadHeader{"NegativeWidth", kXyz + "WIDTH -5\nHEIGHT 1\nDATA ascii\n", "WIDTH"},
        BadHeader{"NegativeCount", "FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 -1\nWIDTH 1\nDATA ascii\n1 2 3",
                  "COUNT"},
        BadHeader{"HugeCount", "FIELDS x y z\nCOUNT 1 1 2000000000\nWIDTH 1\nDATA ascii\n1 2 3", "COUNT"},
        BadHeader{"HugePoint", "FIELDS x y z a b\nCOUNT 1 1 1 3000 3000\nWIDTH 0\nDATA ascii\n", "COUNT"},
        BadHeader{"OddSize", "FIELDS x y z\nSIZE 4 4 3\nWIDTH 1\nDATA ascii\n1 2 3", "SIZE"},
        BadHeader{"HalfFloat", "FIELDS x y z\nSIZE 4 4 2\nTYPE F F F\nWIDTH 1\nDATA ascii\n1 2 3", "SIZE"},
        BadHeader{"FewerTypes", "FIELDS x y z\nTYPE F F\nWIDTH 1\nDATA ascii\n1 2 3", "TYPE"},
        BadHeader{"SizeBeforeFields", "SIZE 4 4 4\nFIELDS x y z\nWIDTH 1\nDATA ascii\n1 2 3", "SIZE"},
        BadHeader{"NoZ", "FIELDS x y\nWIDTH 1\nDATA ascii\n1 2", "no x, y, z"},
        BadHeader{"PointsDiffer", kXyz + "WIDTH 2\nHEIGHT 2\nPOINTS 5\nDATA ascii\n", "5 POINTS"},
        BadHeader{"AsciiShort", kXyz + "WIDTH 2\nHEIGHT 1\nDATA ascii\n1 2 3\n4.0000000 5.000000\n", "cut off"},
        BadHeader{"AsciiWord", kXyz + "WIDTH 1\nHEIGHT 1\nDATA ascii\n1 two 3\n", "no number"},
        BadHeader{"BinaryShort", kXyz + "WIDTH 2\nHEIGHT 1\nDATA binary\n" + std::string(23, 'x'), "cut off"},
        BadHeader{"NoSizes", kXyz + "WIDTH 2\nHEIGHT 1\nDATA binary_compressed\nab", "cut off"},
        BadHeader{"BlockTooLong",
                  kXyz + "WIDTH 1\nHEIGHT 1\nDATA binary_compressed\n" + std::string("\xff\xff\0\0\x0c\0\0\0", 8),
                  "cut off"},
        BadHeader{"OtherPlainSize",
                  kXyz + "WIDTH 1\nHEIGHT 1\nDATA binary_compressed\n" + std::string("\x04\0\0\0\x10\0\0\0abcd", 12),
                  "compressed"},
        BadHeader{"Bomb",
                  kXyz + "WIDTH 300000000\nHEIGHT 1\nDATA binary_compressed\n" +
                      std::string("\x04\0\0\0\0\xa4\x93\xd6"
                                  "abcd",
                                  12),
                  "compressed"},
        BadHeader{"DamagedLzf",
                  kXyz + "WIDTH 1\nHEIGHT 1\nDATA binary_compressed\n" +
                      std::string("\x04\0\0\0\x0c\0\0\0\xff\xff\xff\xff", 12),
                  "LZF"},
        BadHeader{"ZeroQuaternion", kXyz + "WIDTH 1\nHEIGHT 1\nVIEWPOINT 0 0 0 0 0 0 0\nDATA ascii\n1 2 3",
                  "VIEWPOINT"},
        BadHeader{"NanViewpoint", kXyz + "WIDTH 1\nHEIGHT 1\nVIEWPOINT nan 0 0 1 0 0 0\nDATA ascii\n1 2 3",
                  "VIEWPOINT"},
        BadHeader{"UnknownData", kXyz + "WIDTH 1\nHEIGHT 1\nDATA zip\n1 2 3", "DATA"}),
    [](const auto& tested) { return tested.param.what; });

TEST(Pcd, MissingFileAndFolder) {
  io::TestDirectory directory;
  EXPECT_THAT(read_pcd(directory / "none.pcd").error().message, HasSubstr("no such file"));
  EXPECT_THAT(read_pcd(directory.path()).error().message, HasSubstr("is not a file"));
}

TEST(Pcd, WriterRefusesWrongSizes) {
  PcdCloud cloud = random_cloud(false);
  cloud.colors.pop_back();
  EXPECT_THROW((void)write_pcd("x.pcd", cloud), std::invalid_argument);
  cloud = random_cloud(false);
  cloud.width = 30;
  EXPECT_THROW((void)write_pcd("x.pcd", cloud), std::invalid_argument);
}

}  // namespace
}  // namespace resight
