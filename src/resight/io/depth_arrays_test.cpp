// SPDX-License-Identifier: Apache-2.0
#include "resight/io/internal/depth_arrays.hpp"

#include <gmock/gmock.h>

#include <array>
#include <cmath>
#include <map>

#include "resight/io/internal/files.hpp"
#include "resight/io/internal/test_data.hpp"

namespace resight::io {
namespace {

using testing::HasSubstr;

/// Written by NumPy and OpenCV (tests/data/depth/README.md).
fs::path stored(const std::string& name) { return fs::path(RESIGHT_SOURCE_DIR) / "tests/data/depth" / name; }

TEST(DepthArrays, FilesOfOtherWriters) {
  for (const char* name : {"single.npz", "named.npz", "single.exr", "half.exr", "fortran.npy"}) {
    const auto depth_m = read_depth_array(stored(name), std::nullopt);
    ASSERT_TRUE(depth_m.ok()) << depth_m.error().message;
    ASSERT_EQ(depth_m->width(), 8) << name;
    ASSERT_EQ(depth_m->height(), 6) << name;
    const double tolerance_m = std::string(name) == "half.exr" || std::string(name) == "fortran.npy" ? 1e-3 : 1e-6;
    for (int v = 0; v < 6; ++v)
      for (int u = 0; u < 8; ++u) {
        if ((u == 3 && v == 2) || (u == 5 && v == 4))
          EXPECT_TRUE(std::isnan((*depth_m)(u, v))) << name;
        else
          EXPECT_NEAR((*depth_m)(u, v), 1 + 0.01 * (8 * v + u), tolerance_m) << name << " " << u << " " << v;
      }
    EXPECT_NEAR((*read_depth_array(stored(name), 0.001))(1, 0), 0.00101, 1e-5) << name;
  }
}

TEST(DepthArrays, WholeNumbersWithASign) {
  for (const auto& [type, values] : {std::pair(std::string("<i2"), std::string("\xe8\x03\xff\xff", 4)),
                                     {std::string("|i1"), std::string("\x64\xff", 2)}}) {
    std::string dictionary = "{'descr': '" + type + "', 'fortran_order': False, 'shape': (1, 2), }";
    dictionary.resize(118, ' ');
    const auto depth_m = parse_depth_npy(std::string("\x93NUMPY\x01\0\x76\0", 10) + dictionary + values, "d.npy",
                                         type == "<i2" ? 0.001 : 0.01);
    ASSERT_TRUE(depth_m.ok()) << depth_m.error().message;
    EXPECT_NEAR((*depth_m)(0, 0), 1, 1e-6) << type;
    EXPECT_TRUE(std::isnan((*depth_m)(1, 0))) << type;
  }
}

// As renderers and other programs mark the background: finite, but farther than any camera measures.
TEST(DepthArrays, AbsurdDepthIsNoReturn) {
  for (const char* name : {"single.npz", "named.npz", "single.exr", "half.exr", "fortran.npy"}) {
    const auto far = read_depth_array(stored(name), 1e3);
    const auto too_far = read_depth_array(stored(name), 1e5);
    ASSERT_TRUE(far.ok() && too_far.ok()) << name;
    EXPECT_NEAR((*far)(1, 0), 1010, 1) << name;
    EXPECT_TRUE(std::isnan((*too_far)(1, 0))) << name;
  }
}

template <typename T>
std::string raw_bytes(T value) {
  return {reinterpret_cast<const char*>(&value), sizeof(T)};
}

/// An OpenEXR image of two pixels without compression: floating-point channels, in the order of their names.
std::string make_exr(const std::map<std::string, std::array<float, 2>>& channels) {
  const auto attribute = [](const std::string& name, const std::string& type, const std::string& value) {
    return name + '\0' + type + '\0' + raw_bytes(static_cast<std::int32_t>(value.size())) + value;
  };
  std::string list;
  std::string row;
  for (const auto& [name, values] : channels) {
    list += name + '\0' + raw_bytes(2) + raw_bytes(0) + raw_bytes(1) + raw_bytes(1);
    row += raw_bytes(values);
  }
  const std::string window = raw_bytes(std::array<std::int32_t, 4>{0, 0, 1, 0});
  std::string bytes = std::string("\x76\x2f\x31\x01\x02\0\0\0", 8) + attribute("channels", "chlist", list + '\0') +
                      attribute("compression", "compression", std::string(1, '\0')) +
                      attribute("dataWindow", "box2i", window) + attribute("displayWindow", "box2i", window) +
                      attribute("lineOrder", "lineOrder", std::string(1, '\0')) +
                      attribute("pixelAspectRatio", "float", raw_bytes(1.0F)) +
                      attribute("screenWindowCenter", "v2f", std::string(8, '\0')) +
                      attribute("screenWindowWidth", "float", raw_bytes(1.0F)) + '\0';
  bytes += raw_bytes(static_cast<std::uint64_t>(bytes.size() + 8));  // where the row is
  return bytes + raw_bytes(0) + raw_bytes(static_cast<std::int32_t>(row.size())) + row;
}

TEST(DepthArrays, ColoursAreNoDepth) {
  const auto parse = [](const std::map<std::string, std::array<float, 2>>& channels) {
    return parse_depth_exr(make_exr(channels), "d.exr", std::nullopt);
  };
  const std::array<float, 2> depth = {1.5F, 2};
  const std::array<float, 2> other = {1.5F, 1};
  for (const auto& channels : std::vector<std::map<std::string, std::array<float, 2>>>{
           {{"R", other}, {"G", depth}, {"Z", depth}},
           {{"Y", depth}},
           {{"depth.V", depth}},
           {{"R", depth}, {"G", depth}, {"B", depth}, {"A", other}}}) {
    const auto depth_m = parse(channels);
    ASSERT_TRUE(depth_m.ok()) << depth_m.error().message;
    EXPECT_EQ((*depth_m)[0], 1.5F);
    EXPECT_EQ((*depth_m)[1], 2);
  }
  for (const auto& channels : std::vector<std::map<std::string, std::array<float, 2>>>{
           {{"R", depth}, {"G", other}, {"B", depth}}, {{"Y", depth}, {"BY", other}, {"RY", other}}})
    EXPECT_THAT(parse(channels).error().message, HasSubstr("holds no channel of depth"));
}

TEST(DepthArrays, SaysWhichArrayIsMissing) {
  EXPECT_THAT(read_depth_array(stored("unnamed.npz"), std::nullopt).error().message,
              HasSubstr("holds 2 arrays (a, b, ..), none of which is called depth"));
}

TEST(DepthArrays, ChecksumsAreCompared) {
  TestDirectory directory;
  std::string bytes = *read_file(stored("named.npz"));
  const float value = 1.05F;  // of pixel (5, 0), which is not compressed
  const std::size_t at = bytes.find(std::string(reinterpret_cast<const char*>(&value), sizeof(value)));
  ASSERT_NE(at, std::string::npos);
  bytes[at] = static_cast<char>(bytes[at] ^ 1);
  write_text(directory / "d.npz", bytes);
  EXPECT_THAT(read_depth_array(directory / "d.npz", std::nullopt).error().message, HasSubstr("cannot be unpacked"));
}

TEST(DepthArrays, DeclaredSizesAreBounded) {
  // Magic number and version, then an attribute of 2 GB.
  const std::string bytes =
      std::string("\x76\x2f\x31\x01\x02\0\0\0", 8) + std::string("name\0string\0\xf0\xff\xff\x7f", 16) + "x";
  EXPECT_THAT(parse_depth_exr(bytes, "d.exr", std::nullopt).error().message, HasSubstr("cut off"));
}

// OpenEXR reads a number of four bytes, and takes the rest of the value for an attribute of 2 GB.
TEST(DepthArrays, AttributesHaveTheSizeOfTheirType) {
  const std::string inner("b\0opaque\0\xf0\xff\xff\x7f", 13);
  const std::string attributes[] = {
      std::string("a\0int\0\x11\0\0\0xxxx", 14) + inner,
      std::string("a\0chlist\0\x0e\0\0\0\0", 14) + inner,
      std::string("a\0preview\0\x08\0\0\0\0\x40\0\0\0\x40\0\0", 22),
      std::string("a\0stringvector\0\4\0\0\0\xf0\xff\xff\x7f", 23),
      std::string("a\0floatvector\0\3\0\0\0xxx", 21),
  };
  const std::string good = *read_file(stored("single.exr"));
  const std::string sound("a\0int\0\4\0\0\0xxxx", 14);
  EXPECT_THAT(parse_depth_exr(std::string(good).insert(8, sound), "d.exr", std::nullopt).error().message,
              HasSubstr("cannot be decoded"));  // What follows the header is not where it says.
  for (const std::string& attribute : attributes)
    EXPECT_THAT(parse_depth_exr(std::string(good).insert(8, attribute), "d.exr", std::nullopt).error().message,
                HasSubstr("cut off"));
}

// A first part without fault, then one with an attribute of 688 MB, which OpenEXR would allocate.
TEST(DepthArrays, AnOpenexrImageOfSeveralPartsIsRefused) {
  const std::string first("a\0string\0\1\0\0\0x\0", 15);
  const std::string second("b\0string\0\0\0\0\x2bxxxx", 17);
  const std::string bytes = std::string("\x76\x2f\x31\x01\x02\x10\0\0", 8) + first + second;
  EXPECT_THAT(parse_depth_exr(bytes, "d.exr", std::nullopt).error().message, HasSubstr("has several parts"));
}

TEST(DepthArrays, DamageIsAnError) {
  TestDirectory directory;
  Rng rng(3);
  for (const std::string name : {"single.npz", "named.npz", "single.exr", "half.exr", "fortran.npy"}) {
    const std::string good = *read_file(stored(name));
    for (int i = 0; i < 200; ++i) {
      std::string bytes = good.substr(0, i % 2 == 0 ? good.size() : rng.below(static_cast<std::uint32_t>(good.size())));
      if (!bytes.empty())
        bytes[rng.below(static_cast<std::uint32_t>(bytes.size()))] ^= static_cast<char>(1U << (i % 8));
      write_text(directory / name, bytes);
      const auto depth_m = read_depth_array(directory / name, std::nullopt);
      EXPECT_TRUE(depth_m.ok() || depth_m.error().message.find(name) != std::string::npos);
    }
    write_text(directory / name, good.substr(0, good.size() / 2));
    EXPECT_FALSE(read_depth_array(directory / name, std::nullopt).ok()) << name;
  }
}

}  // namespace
}  // namespace resight::io
