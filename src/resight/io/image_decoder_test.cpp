// SPDX-License-Identifier: Apache-2.0
#include "resight/io/internal/image_decoder.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <png.h>

#include <algorithm>
#include <cstdlib>
#include <opencv2/imgcodecs.hpp>

#include "resight/core/random.hpp"
#include "resight/io/images.hpp"
#include "resight/io/internal/libjpeg.hpp"

namespace resight::io {
namespace {

using testing::AnyOf;
using testing::HasSubstr;

constexpr int kWidth = 37;
constexpr int kHeight = 29;

struct PngKind {
  int color_type;
  int bit_depth;
  bool has_transparent_colors = false;
  bool is_interlaced = false;
};

std::string encode_png(const PngKind& kind) {
  std::string bytes;
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
  png_infop info = png_create_info_struct(png);
  const auto append = [](png_structp target, png_bytep data, std::size_t num_bytes) {
    static_cast<std::string*>(png_get_io_ptr(target))->append(reinterpret_cast<const char*>(data), num_bytes);
  };
  png_set_write_fn(png, &bytes, append, nullptr);
  png_set_IHDR(png, info, kWidth, kHeight, kind.bit_depth, kind.color_type,
               kind.is_interlaced ? PNG_INTERLACE_ADAM7 : PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT,
               PNG_FILTER_TYPE_DEFAULT);
  Rng rng(1);
  const auto random_byte = [&rng] { return static_cast<png_byte>(rng.below(256)); };
  std::vector<png_color> palette(std::size_t{1} << std::min(kind.bit_depth, 8));
  for (png_color& color : palette) color = {random_byte(), random_byte(), random_byte()};
  std::vector<png_byte> alphas(palette.size(), 100);
  png_color_16 transparent{};
  if (kind.color_type == PNG_COLOR_TYPE_PALETTE)
    png_set_PLTE(png, info, palette.data(), static_cast<int>(palette.size()));
  if (kind.has_transparent_colors)
    png_set_tRNS(png, info, alphas.data(), static_cast<int>(alphas.size()), &transparent);
  png_write_info(png, info);
  std::vector<std::vector<png_byte>> rows(kHeight, std::vector<png_byte>(png_get_rowbytes(png, info)));
  std::vector<png_bytep> row_starts;
  for (auto& row : rows) {
    std::ranges::generate(row, random_byte);
    row_starts.push_back(row.data());
  }
  png_write_image(png, row_starts.data());
  png_write_end(png, info);
  png_destroy_write_struct(&png, &info);
  return bytes;
}

enum class Scans { kOne, kOnePerChannel, kProgressive };

struct JpegKind {
  J_COLOR_SPACE color_space;
  int num_channels;
  int sampling = 1;  ///< 2: colour at half resolution.
  Scans scans = Scans::kOne;
};

std::string encode_jpeg(const JpegKind& kind) {
  jpeg_compress_struct jpeg{};
  jpeg_error_mgr errors{};
  jpeg.err = jpeg_std_error(&errors);
  jpeg_create_compress(&jpeg);
  unsigned char* buffer = nullptr;
  unsigned long size = 0;  // NOLINT(google-runtime-int): type of libjpeg
  jpeg_mem_dest(&jpeg, &buffer, &size);
  jpeg.image_width = kWidth;
  jpeg.image_height = kHeight;
  jpeg.input_components = kind.num_channels;
  jpeg.in_color_space = kind.color_space;
  jpeg_set_defaults(&jpeg);
  jpeg.comp_info[0].h_samp_factor = jpeg.comp_info[0].v_samp_factor = kind.sampling;
  if (kind.scans == Scans::kProgressive) jpeg_simple_progression(&jpeg);
  constexpr jpeg_scan_info kOnePerChannel[] = {{1, {0}, 0, 63, 0, 0}, {1, {1}, 0, 63, 0, 0}, {1, {2}, 0, 63, 0, 0}};
  if (kind.scans == Scans::kOnePerChannel) {
    jpeg.scan_info = kOnePerChannel;
    jpeg.num_scans = 3;
  }
  jpeg_start_compress(&jpeg, TRUE);
  Rng rng(2);
  std::vector<unsigned char> row(static_cast<std::size_t>(kWidth * kind.num_channels));
  for (int v = 0; v < kHeight; ++v) {
    for (unsigned char& value : row) value = static_cast<unsigned char>(rng.below(256));
    unsigned char* start = row.data();
    jpeg_write_scanlines(&jpeg, &start, 1);
  }
  jpeg_finish_compress(&jpeg);
  std::string bytes(reinterpret_cast<const char*>(buffer), size);
  jpeg_destroy_compress(&jpeg);
  std::free(buffer);
  return bytes;
}

/// The pixels in our order of channels; OpenCV's is blue, green, red, alpha.
std::vector<std::uint8_t> decode_with_opencv(const std::string& bytes, int flags, int num_channels) {
  const std::vector<unsigned char> copy(bytes.begin(), bytes.end());
  const cv::Mat image = cv::imdecode(copy, flags);
  const std::vector<std::vector<std::size_t>> kOrders = {{0}, {0, 3}, {2, 1, 0}, {2, 1, 0, 3}};
  const std::size_t channel_bytes = image.elemSize1();
  std::vector<std::uint8_t> pixels;
  for (int v = 0; v < image.rows; ++v)
    for (int u = 0; u < image.cols; ++u)
      for (const std::size_t channel : kOrders.at(static_cast<std::size_t>(num_channels - 1))) {
        const unsigned char* value =
            image.ptr(v) + static_cast<std::size_t>(u) * image.elemSize() + channel * channel_bytes;
        pixels.insert(pixels.end(), value, value + channel_bytes);
      }
  return pixels;
}

/// Compares both layouts with what OpenCV decodes.
void expect_same_pixels(const std::string& bytes, int num_channels) {
  const auto stored = *make_image_decoder(bytes);
  const auto header = stored->read_header();
  ASSERT_TRUE(header.ok()) << header.error().message;
  ASSERT_EQ(header->num_channels, num_channels);
  ASSERT_EQ(header->width * header->height, kWidth * kHeight);
  std::vector<std::uint8_t> pixels(static_cast<std::size_t>(kWidth * kHeight * num_channels * header->channel_bytes));
  const auto done = stored->read_pixels(PixelLayout::kStored, pixels.data());
  ASSERT_TRUE(done.ok()) << done.error().message;
  EXPECT_EQ(pixels, decode_with_opencv(bytes, cv::IMREAD_UNCHANGED, num_channels));
  const auto colored = *make_image_decoder(bytes);
  ASSERT_TRUE(colored->read_header().ok());
  std::vector<std::uint8_t> rgb(std::size_t{3} * kWidth * kHeight);
  ASSERT_TRUE(colored->read_pixels(PixelLayout::kRgb8, rgb.data()).ok());
  EXPECT_EQ(rgb, decode_with_opencv(bytes, cv::IMREAD_COLOR | cv::IMREAD_IGNORE_ORIENTATION, 3));
}

TEST(ImageDecoder, PngsHaveThePixelsOfOpenCv) {
  const auto expect_same = [](PngKind kind, int num_channels) {
    for (const bool is_interlaced : {false, true}) {
      SCOPED_TRACE(fmt::format("type {}, {} bits, transparent {}, interlaced {}", kind.color_type, kind.bit_depth,
                               kind.has_transparent_colors, is_interlaced));
      kind.is_interlaced = is_interlaced;
      expect_same_pixels(encode_png(kind), num_channels);
    }
  };
  for (const int bit_depth : {1, 2, 4, 8, 16}) expect_same({PNG_COLOR_TYPE_GRAY, bit_depth}, 1);
  for (const int bit_depth : {1, 2, 4, 8}) {
    expect_same({PNG_COLOR_TYPE_PALETTE, bit_depth}, 3);
    expect_same({PNG_COLOR_TYPE_PALETTE, bit_depth, true}, 3);
  }
  for (const int bit_depth : {8, 16}) {
    expect_same({PNG_COLOR_TYPE_GRAY, bit_depth, true}, 1);
    expect_same({PNG_COLOR_TYPE_GRAY_ALPHA, bit_depth}, 2);
    expect_same({PNG_COLOR_TYPE_RGB, bit_depth}, 3);
    expect_same({PNG_COLOR_TYPE_RGB, bit_depth, true}, 3);
    expect_same({PNG_COLOR_TYPE_RGBA, bit_depth}, 4);
  }
}

TEST(ImageDecoder, JpegsHaveThePixelsOfOpenCv) {
  for (const Scans scans : {Scans::kOne, Scans::kProgressive}) {
    SCOPED_TRACE(scans == Scans::kOne ? "one scan" : "progressive");
    expect_same_pixels(encode_jpeg({JCS_GRAYSCALE, 1, 1, scans}), 1);
    expect_same_pixels(encode_jpeg({JCS_RGB, 3, 1, scans}), 3);
    expect_same_pixels(encode_jpeg({JCS_RGB, 3, 2, scans}), 3);
    expect_same_pixels(encode_jpeg({JCS_CMYK, 4, 1, scans}), 3);
  }
  expect_same_pixels(encode_jpeg({JCS_RGB, 3, 1, Scans::kOnePerChannel}), 3);
}

/// What a caller is told; empty if the image is read. Fails if the library prints anything.
std::string decode_silently(const std::string& bytes) {
  testing::internal::CaptureStderr();
  const auto color = decode_color(bytes, "c.jpg");
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
  return color.ok() ? "" : color.error().message;
}

TEST(ImageDecoder, InventedPixelsOfADamagedJpegAreAnError) {
  for (const Scans scans : {Scans::kOne, Scans::kProgressive}) {
    const std::string bytes = encode_jpeg({JCS_RGB, 3, 2, scans});
    const std::size_t start = bytes.find("\xff\xda") + 14;
    EXPECT_EQ(decode_silently(bytes), "");
    EXPECT_THAT(decode_silently(std::string(bytes).erase(start, 40)), HasSubstr("c.jpg: the image is damaged ("));
    int num_refused = 0;
    for (std::size_t at = start; at + 2 < bytes.size(); at += 5) {
      std::string damaged = bytes;
      damaged[at] = static_cast<char>(damaged[at] ^ 16);
      const std::string message = decode_silently(damaged);
      EXPECT_THAT(message, AnyOf("", HasSubstr("the image is "), HasSubstr("cannot be decoded")));
      if (!message.empty()) ++num_refused;
    }
    EXPECT_GT(num_refused, 20) << "A JPEG has no checksum: not all damage can be found.";
  }
}

TEST(ImageDecoder, PaddingOfAJpegIsNoDamage) {
  const std::string bytes = encode_jpeg({JCS_RGB, 3});
  const std::size_t end = bytes.size() - 2;
  EXPECT_EQ(decode_silently(std::string(bytes).insert(end, std::string(16, 'x'))), "");
  EXPECT_THAT(decode_silently(std::string(bytes).insert(end, std::string(32, 'x'))),
              HasSubstr("extraneous bytes before marker 0xd9"));
  EXPECT_EQ(decode_silently(std::string(bytes).insert(bytes.find("\xff\xdb"), std::string(600, 'x'))), "");
}

// The scan of a channel, again and again: each one costs the time of the whole image.
TEST(ImageDecoder, AJpegOfTooManyScansIsRefused) {
  const std::string bytes = encode_jpeg({JCS_RGB, 3, 1, Scans::kOnePerChannel});
  const std::size_t scan = bytes.rfind("\xff\xda");
  const std::string last_scan = bytes.substr(scan, bytes.size() - scan - 2);
  const auto with_scans_more = [&](int num_scans) {
    std::string bomb = bytes.substr(0, scan);
    for (int i = 0; i <= num_scans; ++i) bomb += last_scan;
    return bomb + "\xff\xd9";
  };
  EXPECT_EQ(decode_silently(with_scans_more(97)), "");
  EXPECT_THAT(decode_silently(with_scans_more(98)), HasSubstr("more than 100 scans"));
  // Behind the end, there may be other images.
  std::string pictures = bytes;
  for (int i = 0; i < 500; ++i) pictures += bytes;
  EXPECT_EQ(decode_silently(pictures), "");
}

}  // namespace
}  // namespace resight::io
