// SPDX-License-Identifier: Apache-2.0
#include "resight/io/images.hpp"

#include <fmt/format.h>

#include <bit>
#include <cmath>
#include <cstring>
#include <opencv2/imgcodecs.hpp>

#include "resight/io/internal/bgr_image.hpp"
#include "resight/io/internal/files.hpp"
#include "resight/io/internal/image_header.hpp"
#include "resight/sensor/rgbd_frame.hpp"

namespace resight {
namespace {

constexpr int kMaxScans = 100;  ///< Encoders make about ten.

Result<cv::Mat> decode(std::string_view bytes, std::string_view name, int flags, std::int64_t max_pixels) {
  const auto fail = [&](std::string_view what) { return Error{fmt::format("{}: {}", name, what)}; };
  const auto header = io::parse_image_header(bytes);
  if (!header) return fail("is not a supported image (expected PNG or JPEG)");
  if (header->width <= 0 || header->height <= 0 || header->width > kMaxImageSide_px ||
      header->height > kMaxImageSide_px || std::int64_t{header->width} * header->height > max_pixels)
    return fail(fmt::format("the image size {}x{} is out of range (at most {} px per side and {} px in all)",
                            header->width, header->height, kMaxImageSide_px, max_pixels));
  if (header->num_scans > kMaxScans) return fail(fmt::format("the image has more than {} scans", kMaxScans));
  if (!header->complete) return fail("the image is cut off");
  if (!header->intact) return fail("the image is damaged (a checksum does not match)");
  try {
    std::string pixels = io::keep_pixels(bytes);
    const cv::Mat encoded(1, static_cast<int>(pixels.size()), CV_8UC1, pixels.data());
    cv::Mat image = cv::imdecode(encoded, flags);
    if (image.cols != header->width || image.rows != header->height)
      return fail("the image cannot be decoded (damaged?)");
    return image;
  } catch (const cv::Exception&) {
    return fail("the image cannot be decoded (damaged?)");
  }
}

Result<cv::Mat> read(const std::filesystem::path& file, int flags, std::int64_t max_pixels) {
  const auto bytes = io::read_file(file);
  if (!bytes) return bytes.error();
  return decode(*bytes, file.string(), flags, max_pixels);
}

/// Keeps the orientation of the file, so that depth and colour remain registered.
constexpr int kColorFlags = cv::IMREAD_COLOR | cv::IMREAD_IGNORE_ORIENTATION;

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
  const auto bgr = decode(bytes, name, kColorFlags, max_pixels);
  if (!bgr) return bgr.error();
  return io::from_bgr(*bgr);
}

Result<Image<Rgb8>> read_color(const std::filesystem::path& file, std::int64_t max_pixels) {
  const auto bgr = read(file, kColorFlags, max_pixels);
  if (!bgr) return bgr.error();
  return io::from_bgr(*bgr);
}

Result<Image<std::uint16_t>> read_depth_raw(const std::filesystem::path& file) {
  const auto bytes = io::read_file(file);
  if (!bytes) return bytes.error();
  return decode_depth_raw(*bytes, file.string());
}

Result<Image<std::uint16_t>> decode_depth_raw(std::string_view bytes, std::string_view name) {
  const auto image = decode(bytes, name, cv::IMREAD_UNCHANGED, kMaxViewPixels);
  if (!image) return image.error();
  if (image->channels() != 1 || (image->depth() != CV_16U && image->depth() != CV_8U))
    return Error{fmt::format("{}: {} channels of {} bytes; expected a depth image: one channel of 16 bits", name,
                             image->channels(), image->elemSize1())};
  Image<std::uint16_t> raw(image->cols, image->rows);
  for (int v = 0; v < image->rows; ++v)
    for (int u = 0; u < image->cols; ++u)
      raw(u, v) = image->depth() == CV_16U ? image->at<std::uint16_t>(v, u) : image->at<std::uint8_t>(v, u);
  return raw;
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
  const auto image = read(file, cv::IMREAD_UNCHANGED, kMaxViewPixels);
  if (!image) return image.error();
  Image<std::uint8_t> mask(image->cols, image->rows, 0);
  const std::size_t pixel_bytes = image->elemSize();
  const bool has_alpha = image->channels() == 2 || image->channels() == 4;
  const std::size_t color_bytes = pixel_bytes - (has_alpha ? image->elemSize1() : 0);
  for (int v = 0; v < image->rows; ++v)
    for (int u = 0; u < image->cols; ++u) {
      const unsigned char* pixel = image->ptr(v) + static_cast<std::size_t>(u) * pixel_bytes;
      for (std::size_t i = 0; i < color_bytes; ++i)
        if (pixel[i] != 0) mask(u, v) = 255;
    }
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
