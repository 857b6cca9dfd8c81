// SPDX-License-Identifier: Apache-2.0
#include "resight/io/images.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <memory>
#include <opencv2/imgcodecs.hpp>
#include <vector>

#include "resight/core/check.hpp"
#include "resight/io/internal/files.hpp"
#include "resight/io/internal/image_decoder.hpp"
#include "resight/sensor/rgbd_frame.hpp"

namespace resight {
namespace {

struct OpenImage {
  std::unique_ptr<io::ImageDecoder> decoder;
  io::ImageHeader header;
};

/// Reads the header and checks the size before there is memory for the pixels.
Result<OpenImage> open_image(std::string_view bytes, std::int64_t max_pixels) {
  auto decoder = io::make_image_decoder(bytes);
  if (!decoder) return decoder.error();
  const auto header = (*decoder)->read_header();
  if (!header) return header.error();
  const int width = header->width;
  const int height = header->height;
  if (width > kMaxImageSide_px || height > kMaxImageSide_px || std::int64_t{width} * height > max_pixels)
    return Error{fmt::format("the image size {}x{} is out of range (at most {} px per side and {} px in all)", width,
                             height, kMaxImageSide_px, max_pixels)};
  return OpenImage{std::move(*decoder), *header};
}

Result<Image<Rgb8>> decode_rgb(std::string_view bytes, std::int64_t max_pixels) {
  const auto image = open_image(bytes, max_pixels);
  if (!image) return image.error();
  Image<Rgb8> color(image->header.width, image->header.height);
  static_assert(sizeof(Rgb8) == 3);
  auto* pixels = reinterpret_cast<std::uint8_t*>(color.data().data());
  if (const auto done = image->decoder->read_pixels(io::PixelLayout::kRgb8, pixels); !done) return done.error();
  return color;
}

struct StoredImage {
  io::ImageHeader header;
  std::vector<std::uint8_t> bytes;  ///< Row by row without gaps.
};

Result<StoredImage> decode_stored(std::string_view bytes, std::int64_t max_pixels) {
  const auto image = open_image(bytes, max_pixels);
  if (!image) return image.error();
  const auto& [width, height, num_channels, channel_bytes] = image->header;
  const auto num_pixels = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  std::vector<std::uint8_t> pixels(num_pixels * static_cast<std::size_t>(num_channels * channel_bytes));
  if (const auto done = image->decoder->read_pixels(io::PixelLayout::kStored, pixels.data()); !done)
    return done.error();
  return StoredImage{image->header, std::move(pixels)};
}

Result<Image<std::uint16_t>> decode_raw(std::string_view bytes) {
  const auto image = decode_stored(bytes, kMaxViewPixels);
  if (!image) return image.error();
  const auto& [width, height, num_channels, channel_bytes] = image->header;
  if (num_channels != 1)
    return Error{fmt::format("{} channels of {} bytes; expected a depth image: one channel of 16 bits", num_channels,
                             channel_bytes)};
  Image<std::uint16_t> raw(width, height);
  if (channel_bytes == 2)
    std::memcpy(raw.data().data(), image->bytes.data(), image->bytes.size());
  else
    std::ranges::copy(image->bytes, raw.data().begin());
  return raw;
}

/// The result of a decoder, whose error does not say which image is meant.
template <typename T>
Result<T> named(Result<T> image, std::string_view name) {
  if (!image) return Error{fmt::format("{}: {}", name, image.error().message)};
  return image;
}

Result<void> encode(const std::filesystem::path& file, const cv::Mat& image) {
  const std::string extension = io::extension_of(file);
  const bool jpeg = extension == "jpg" || extension == "jpeg";
  std::vector<unsigned char> bytes;
  try {
    const std::vector<int> parameters =
        jpeg ? std::vector<int>{cv::IMWRITE_JPEG_QUALITY, 95} : std::vector<int>{cv::IMWRITE_PNG_COMPRESSION, 3};
    if (!cv::imencode(jpeg ? ".jpg" : ".png", image, bytes, parameters))
      return io::file_error(file, "the image cannot be encoded");
  } catch (const cv::Exception&) {
    return io::file_error(file, "the image cannot be encoded");
  }
  return io::write_file(file, {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
}

}  // namespace

Result<Image<Rgb8>> decode_color(std::string_view bytes, std::string_view name, std::int64_t max_pixels) {
  return named(decode_rgb(bytes, max_pixels), name);
}

Result<Image<Rgb8>> read_color(const std::filesystem::path& file, std::int64_t max_pixels) {
  const auto bytes = io::read_file(file);
  if (!bytes) return bytes.error();
  return decode_color(*bytes, file.string(), max_pixels);
}

Result<Image<std::uint16_t>> read_depth_raw(const std::filesystem::path& file) {
  const auto bytes = io::read_file(file);
  if (!bytes) return bytes.error();
  return decode_depth_raw(*bytes, file.string());
}

Result<Image<std::uint16_t>> decode_depth_raw(std::string_view bytes, std::string_view name) {
  return named(decode_raw(bytes), name);
}

Image<float> scale_unsaturated_depth(const Image<std::uint16_t>& raw, double metres_per_unit) {
  Image<float> depth_m(raw.width(), raw.height());
  for (std::size_t i = 0; i < raw.size(); ++i)
    depth_m[i] = depth_or_none(raw[i] == 0xFFFF ? 0 : raw[i] * metres_per_unit);
  return depth_m;
}

Result<Image<float>> read_depth(const std::filesystem::path& file, double metres_per_unit) {
  require(metres_per_unit > 0 && std::isfinite(metres_per_unit), "read_depth: metres_per_unit must be positive");
  const auto raw = read_depth_raw(file);
  if (!raw) return raw.error();
  Image<float> depth_m(raw->width(), raw->height());
  for (std::size_t i = 0; i < raw->size(); ++i) depth_m[i] = depth_or_none((*raw)[i] * metres_per_unit);
  return depth_m;
}

Result<Image<std::uint8_t>> read_mask(const std::filesystem::path& file) {
  const auto bytes = io::read_file(file);
  if (!bytes) return bytes.error();
  const auto image = named(decode_stored(*bytes, kMaxViewPixels), file.string());
  if (!image) return image.error();
  const auto& [width, height, num_channels, channel_bytes] = image->header;
  Image<std::uint8_t> mask(width, height, 0);
  const auto pixel_bytes = static_cast<std::size_t>(num_channels * channel_bytes);
  const bool has_alpha = num_channels == 2 || num_channels == 4;
  const std::size_t color_bytes = pixel_bytes - static_cast<std::size_t>(has_alpha ? channel_bytes : 0);
  const std::uint8_t* pixel = image->bytes.data();
  for (std::size_t i = 0; i < mask.size(); ++i, pixel += pixel_bytes)
    if (std::any_of(pixel, pixel + color_bytes, [](std::uint8_t byte) { return byte != 0; })) mask[i] = 255;
  return mask;
}

Result<void> write_color(const std::filesystem::path& file, const Image<Rgb8>& color) {
  require(!color.empty(), "write_color: the image is empty");
  cv::Mat bgr(color.height(), color.width(), CV_8UC3);
  for (int v = 0; v < color.height(); ++v) {
    auto* target = bgr.ptr<unsigned char>(v);
    for (const Rgb8& c : color.row(v)) {
      target[0] = c.b;
      target[1] = c.g;
      target[2] = c.r;
      target += 3;
    }
  }
  return encode(file, bgr);
}

Result<void> write_depth(const std::filesystem::path& file, const Image<float>& depth_m, double metres_per_unit) {
  require(!depth_m.empty(), "write_depth: the image is empty");
  require(metres_per_unit > 0 && std::isfinite(metres_per_unit), "write_depth: metres_per_unit must be positive");
  cv::Mat raw(depth_m.height(), depth_m.width(), CV_16UC1);
  for (int v = 0; v < depth_m.height(); ++v)
    for (int u = 0; u < depth_m.width(); ++u) {
      const double units = std::round(depth_m(u, v) / metres_per_unit);
      if (!std::isnan(units) && !(units >= 1 && units <= 65535))
        return io::file_error(file, fmt::format("depth {} m at pixel ({}, {}) does not fit into 16 bits of {} m",
                                                depth_m(u, v), u, v, metres_per_unit));
      raw.at<std::uint16_t>(v, u) = std::isnan(units) ? std::uint16_t{0} : static_cast<std::uint16_t>(units);
    }
  return encode(file, raw);
}

Result<void> write_mask(const std::filesystem::path& file, const Image<std::uint8_t>& mask) {
  require(!mask.empty(), "write_mask: the image is empty");
  cv::Mat image(mask.height(), mask.width(), CV_8UC1);
  for (int v = 0; v < mask.height(); ++v)
    for (int u = 0; u < mask.width(); ++u) image.at<std::uint8_t>(v, u) = mask(u, v) != 0 ? 255 : 0;
  return encode(file, image);
}

}  // namespace resight
