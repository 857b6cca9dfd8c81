// SPDX-License-Identifier: Apache-2.0
#include "resight/io/images.hpp"

#include <gmock/gmock.h>

#include <cmath>

#include "resight/core/crc32.hpp"
#include "resight/io/internal/test_data.hpp"

namespace resight {
namespace {

using testing::HasSubstr;

std::string big_endian_bytes(std::uint32_t number) {
  std::string bytes;
  for (const int shift : {24, 16, 8, 0}) bytes += static_cast<char>(number >> shift & 0xff);
  return bytes;
}

std::string make_png_chunk(const std::string& content) {
  return big_endian_bytes(static_cast<std::uint32_t>(content.size() - 4)) + content +
         big_endian_bytes(compute_crc32(content));
}

/// A PNG with another size in its header.
std::string with_size(std::string png, std::uint32_t width, std::uint32_t height) {
  const std::string header = "IHDR" + big_endian_bytes(width) + big_endian_bytes(height) + png.substr(24, 5);
  return png.replace(8, 25, make_png_chunk(header));
}

TEST(Images, PngColourAndDepthAreExact) {
  io::TestDirectory directory;
  const RgbdFrame frame = io::random_frame("a", 1);
  ASSERT_TRUE(write_color(directory / "c.png", frame.color).ok());
  ASSERT_TRUE(write_depth(directory / "d.png", frame.depth_m, 1e-4).ok());
  EXPECT_EQ(*read_color(directory / "c.png"), frame.color);
  EXPECT_EQ(io::depth_difference_m(*read_depth(directory / "d.png", 1e-4), frame.depth_m), 0);
  // Rounding to whole millimetres loses at most half a millimetre.
  ASSERT_TRUE(write_depth(directory / "mm.png", frame.depth_m, 1e-3).ok());
  const double lost = io::depth_difference_m(*read_depth(directory / "mm.png", 1e-3), frame.depth_m);
  EXPECT_GT(lost, 1e-4);
  EXPECT_LT(lost, 5.01e-4);
}

TEST(Images, JpegIsNear) {
  io::TestDirectory directory;
  const Image<Rgb8> color(32, 24, Rgb8{200, 100, 50});
  ASSERT_TRUE(write_color(directory / "c.jpg", color).ok());
  const auto read = read_color(directory / "c.jpg");
  ASSERT_TRUE(read.ok());
  EXPECT_NEAR((*read)(5, 5).r, 200, 4);
  EXPECT_NEAR((*read)(5, 5).b, 50, 4);
}

TEST(Images, MasksAreZeroOr255) {
  io::TestDirectory directory;
  Image<std::uint8_t> mask(9, 7, 0);
  mask(3, 2) = 1;
  ASSERT_TRUE(write_mask(directory / "m.png", mask).ok());
  const auto read = read_mask(directory / "m.png");
  EXPECT_EQ((*read)(3, 2), 255);
  EXPECT_EQ(std::ranges::count(read->data(), 255), 1);
}

// As image editors save them: an opaque black pixel and an opaque green one.
TEST(Images, TheAlphaOfAMaskDoesNotCount) {
  io::TestDirectory directory;
  constexpr unsigned char kRgba[] = {
      0x89, 'P',  'N',  'G',  0x0d, 0x0a, 0x1a, 0x0a, 0x00, 0x00, 0x00, 0x0d, 'I',  'H',  'D',  'R',  0x00, 0x00, 0x00,
      0x02, 0x00, 0x00, 0x00, 0x01, 0x08, 0x06, 0x00, 0x00, 0x00, 0xf4, 0x22, 0x7f, 0x8a, 0x00, 0x00, 0x00, 0x11, 'I',
      'D',  'A',  'T',  0x78, 0x9c, 0x63, 0x60, 0x60, 0x60, 0xf8, 0xcf, 0xc0, 0xc9, 0xf0, 0x1f, 0x00, 0x06, 0x1e, 0x02,
      0x08, 0xe9, 0x8d, 0x74, 0xa9, 0x00, 0x00, 0x00, 0x00, 'I',  'E',  'N',  'D',  0xae, 0x42, 0x60, 0x82};
  io::write_text(directory / "m.png", std::string(reinterpret_cast<const char*>(kRgba), sizeof kRgba));
  const auto mask = read_mask(directory / "m.png");
  ASSERT_TRUE(mask.ok()) << mask.error().message;
  EXPECT_EQ((*mask)(0, 0), 0);
  EXPECT_EQ((*mask)(1, 0), 255);
}

// A marker without a segment, then a start of frame that is too large, and the start of a scan.
TEST(Images, TheSizeOfAJpegIsCheckedBeforeItIsDecoded) {
  const std::string bytes(
      "\xff\xd8\xff\x01"
      "\xff\xc0\x00\x11\x08\x4e\x20\x4e\x20\x03\x01\x11\x00\x02\x11\x00\x03\x11\x00"
      "\xff\xda\x00\x0c\x03\x01\x00\x02\x00\x03\x00\x00\x3f\x00",
      37);
  EXPECT_THAT(decode_color(bytes, "bomb.jpg").error().message, HasSubstr("20000x20000 is out of range"));
}

TEST(Images, JpegMayBeFollowedByOtherData) {
  io::TestDirectory directory;
  ASSERT_TRUE(write_color(directory / "c.jpg", Image<Rgb8>(32, 24, Rgb8{200, 100, 50})).ok());
  std::string bytes = io::read_text(directory / "c.jpg");
  EXPECT_TRUE(decode_color(bytes + std::string(1000, 'x'), "motion.jpg").ok());
  const std::string comment("\xff\xfe\x00\x03x", 5);
  EXPECT_TRUE(decode_color(std::string(bytes).insert(bytes.size() - 2, comment), "comment.jpg").ok());
  bytes.resize(bytes.size() - 10);
  EXPECT_THAT(decode_color(bytes, "cut.jpg").error().message, HasSubstr("cut off"));
}

TEST(Images, DepthThatDoesNotFitIsAnError) {
  io::TestDirectory directory;
  EXPECT_THAT(write_depth(directory / "d.png", Image<float>(2, 2, 7.0F), 1e-4).error().message,
              HasSubstr("does not fit"));
  EXPECT_THAT(write_depth(directory / "d.png", Image<float>(2, 2, 0.0001F), 1e-3).error().message,
              HasSubstr("does not fit"));
  EXPECT_FALSE(std::filesystem::exists(directory / "d.png"));
}

TEST(Images, BadFiles) {
  io::TestDirectory directory;
  EXPECT_THAT(read_color(directory / "none.png").error().message, HasSubstr("no such file"));
  io::write_text(directory / "text.png", "hello");
  EXPECT_THAT(read_color(directory / "text.png").error().message, HasSubstr("expected PNG or JPEG"));
  ASSERT_TRUE(write_color(directory / "c.png", io::random_frame("a", 1).color).ok());
  const std::string bytes = io::read_text(directory / "c.png");
  io::write_text(directory / "cut.png", bytes.substr(0, bytes.size() / 2));
  EXPECT_THAT(read_color(directory / "cut.png").error().message, HasSubstr("cut off"));
  io::write_text(directory / "huge.png", with_size(bytes, 65536, 65536));
  EXPECT_THAT(read_color(directory / "huge.png").error().message, HasSubstr("out of range"));
  io::write_text(directory / "large.png", with_size(bytes, 16384, 8192));  // allowed for a texture
  EXPECT_THAT(read_color(directory / "large.png").error().message, HasSubstr("cannot be decoded"));
  for (const std::string& message :
       {read_color(directory / "large.png", kMaxViewPixels).error().message,
        read_depth(directory / "large.png", 1e-3).error().message, read_mask(directory / "large.png").error().message})
    EXPECT_THAT(message, HasSubstr("16384x8192 is out of range"));
  EXPECT_THAT(read_depth(directory / "c.png", 1e-3).error().message, HasSubstr("one channel of 16 bits"));
}

TEST(Images, AFlippedBitInAPngIsFound) {
  const std::string name = "c.png";
  io::TestDirectory directory;
  ASSERT_TRUE(write_color(directory / name, io::random_frame("a", 1).color).ok());
  const std::string bytes = io::read_text(directory / name);
  for (std::size_t at = 41; at + 16 < bytes.size(); at += 97) {  // within the compressed data
    std::string damaged = bytes;
    damaged[at] = static_cast<char>(damaged[at] ^ 4);
    EXPECT_THAT(decode_color(damaged, name).error().message, HasSubstr("the image cannot be decoded (")) << at;
  }
  EXPECT_TRUE(decode_color(bytes, name).ok());
}

// A colour profile that is too short, and a damaged time: libpng would complain and print the name of the profile.
TEST(Images, NoTextOfAPngReachesTheTerminal) {
  io::TestDirectory directory;
  const Image<Rgb8> color = io::random_frame("a", 1).color;
  ASSERT_TRUE(write_color(directory / "c.png", color).ok());
  std::string bytes = io::read_text(directory / "c.png");
  const std::string stored_block("\x78\x01\x01\x84\x00\x7b\xff", 7);
  const std::string profile = std::string("iCCP\x1b[31mforged\nline\0\0", 22) + stored_block + std::string(136, '\0');
  constexpr std::size_t kBehindHeader = 33;
  bytes.insert(kBehindHeader, make_png_chunk(profile) + make_png_chunk("tIMEwrong"));
  testing::internal::CaptureStderr();
  const auto decoded = decode_color(bytes, "c.png");
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
  ASSERT_TRUE(decoded.ok()) << decoded.error().message;
  EXPECT_EQ(*decoded, color);
}

TEST(Images, NumpyDepth) {
  io::TestDirectory directory;
  std::string dictionary = "{'descr': '<f4', 'fortran_order': False, 'shape': (2, 3), }";
  dictionary.resize(118, ' ');
  std::string bytes = std::string("\x93NUMPY\x01\0", 8) + std::string("\x76\0", 2) + dictionary;
  for (const float z : {1.5F, 0.0F, -1.0F, std::numeric_limits<float>::infinity(), std::nanf(""), 2.25F})
    bytes.append(reinterpret_cast<const char*>(&z), 4);
  io::write_text(directory / "d.npy", bytes);
  const auto depth = read_depth_npy(directory / "d.npy");
  ASSERT_TRUE(depth.ok()) << depth.error().message;
  EXPECT_EQ(depth->width(), 3);
  EXPECT_EQ((*depth)(0, 0), 1.5F);
  EXPECT_EQ((*depth)(2, 1), 2.25F);
  EXPECT_EQ(std::ranges::count_if(depth->data(), [](float z) { return std::isnan(z); }), 4);
  io::write_text(directory / "cut.npy", bytes.substr(0, bytes.size() - 1));
  EXPECT_THAT(read_depth_npy(directory / "cut.npy").error().message, HasSubstr("cut off"));
  bytes.replace(bytes.find("<f4"), 3, "<f8");
  io::write_text(directory / "double.npy", bytes);
  EXPECT_THAT(read_depth_npy(directory / "double.npy").error().message, HasSubstr("cut off"));
  bytes.replace(bytes.find("<f8"), 3, "<c8");
  io::write_text(directory / "complex.npy", bytes);
  EXPECT_THAT(read_depth_npy(directory / "complex.npy").error().message, HasSubstr("'<f4'"));
}

TEST(Images, NumpyWholeNumbersNeedAUnit) {
  io::TestDirectory directory;
  std::string dictionary = "{'descr': '<u2', 'fortran_order': False, 'shape': (1, 3, 1), }";
  dictionary.resize(118, ' ');
  const std::string header = std::string("\x93NUMPY\x01\0", 8) + std::string("\x76\0", 2) + dictionary;
  io::write_text(directory / "d.npy", header + std::string("\xe8\x03\0\0\xd0\x07", 6));
  EXPECT_THAT(read_depth_npy(directory / "d.npy").error().message, HasSubstr("--depth-scale"));
  const auto depth = read_depth_npy(directory / "d.npy", 0.001);
  ASSERT_TRUE(depth.ok()) << depth.error().message;
  EXPECT_FLOAT_EQ((*depth)[0], 1.0F);
  EXPECT_TRUE(std::isnan((*depth)[1]));
  EXPECT_FLOAT_EQ((*depth)[2], 2.0F);
}

}  // namespace
}  // namespace resight
