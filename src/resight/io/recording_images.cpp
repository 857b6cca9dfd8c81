// SPDX-License-Identifier: Apache-2.0
#include "resight/io/internal/recording_images.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <opencv2/imgproc.hpp>

#include "resight/core/printable.hpp"
#include "resight/io/images.hpp"
#include "resight/io/internal/image_decoder.hpp"
#include "resight/io/internal/text.hpp"
#include "resight/recordings/message.hpp"
#include "resight/sensor/rgbd_frame.hpp"

namespace resight::io {
namespace {

/// Encodings of sensor_msgs/Image that show colour. `to_bgr`: conversion of OpenCV, or one of the two below.
struct ColorEncoding {
  std::string_view name;
  int channels;
  int to_bgr;
};
constexpr int kIsBgr = -1;
constexpr int kFromGrey = -2;
constexpr std::array<ColorEncoding, 16> kColorEncodings = {{{"rgb8", 3, cv::COLOR_RGB2BGR},
                                                            {"bgr8", 3, kIsBgr},
                                                            {"rgba8", 4, cv::COLOR_RGBA2BGR},
                                                            {"bgra8", 4, cv::COLOR_BGRA2BGR},
                                                            {"8UC3", 3, kIsBgr},
                                                            {"8UC4", 4, cv::COLOR_BGRA2BGR},
                                                            {"mono8", 1, kFromGrey},
                                                            {"8UC1", 1, kFromGrey},
                                                            {"bayer_rggb8", 1, cv::COLOR_BayerBG2BGR},
                                                            {"bayer_bggr8", 1, cv::COLOR_BayerRG2BGR},
                                                            {"bayer_gbrg8", 1, cv::COLOR_BayerGR2BGR},
                                                            {"bayer_grbg8", 1, cv::COLOR_BayerGB2BGR},
                                                            {"yuv422", 2, cv::COLOR_YUV2BGR_UYVY},
                                                            {"uyvy", 2, cv::COLOR_YUV2BGR_UYVY},
                                                            {"yuv422_yuy2", 2, cv::COLOR_YUV2BGR_YUY2},
                                                            {"yuyv", 2, cv::COLOR_YUV2BGR_YUY2}}};

const ColorEncoding* find_color_encoding(std::string_view name) {
  const auto it = std::ranges::find(kColorEncodings, name, &ColorEncoding::name);
  return it == kColorEncodings.end() ? nullptr : &*it;
}

/// Checks that the message holds all rows of an image with this number of bytes per pixel.
Result<void> check_size(const ImageMessage& image, std::size_t pixel_bytes, std::string_view what) {
  const std::uint64_t pixels = std::uint64_t{image.width} * image.height;
  if (image.width == 0 || image.height == 0 || image.width > kMaxImageSide_px || image.height > kMaxImageSide_px ||
      pixels > kMaxViewPixels)
    return Error{fmt::format("{}: the image size {}x{} is out of range", what, image.width, image.height)};
  const std::uint64_t used = std::uint64_t{image.width} * pixel_bytes;
  const std::uint64_t needed = std::uint64_t{image.row_bytes} * (image.height - 1) + used;
  if (image.row_bytes < used || needed > image.data.size())
    return Error{fmt::format("{}: an image of {}x{} has only {} bytes (damaged)", what, image.width, image.height,
                             image.data.size())};
  return {};
}

Image<Rgb8> from_bgr(const cv::Mat& bgr) {
  Image<Rgb8> color(bgr.cols, bgr.rows);
  for (int v = 0; v < bgr.rows; ++v) {
    const auto* source = bgr.ptr<unsigned char>(v);
    for (Rgb8& c : color.row(v)) {
      c = {source[2], source[1], source[0]};
      source += 3;
    }
  }
  return color;
}

Result<Image<Rgb8>> decode_raw_color(const ImageMessage& image, std::string_view what) {
  const ColorEncoding* encoding = find_color_encoding(image.encoding);
  if (encoding == nullptr)
    return Error{fmt::format("{}: the encoding '{}' is not supported", what, printable(image.encoding))};
  if (const auto done = check_size(image, static_cast<std::size_t>(encoding->channels), what); !done)
    return done.error();
  const cv::Mat stored(static_cast<int>(image.height), static_cast<int>(image.width), CV_8UC(encoding->channels),
                       const_cast<char*>(image.data.data()), image.row_bytes);
  cv::Mat bgr;
  try {
    if (encoding->to_bgr == kIsBgr)
      bgr = stored;
    else
      cv::cvtColor(stored, bgr, encoding->to_bgr == kFromGrey ? cv::COLOR_GRAY2BGR : encoding->to_bgr);
  } catch (const cv::Exception&) {
    return Error{fmt::format("{}: an image of {}x{} cannot be {}", what, image.width, image.height, image.encoding)};
  }
  return from_bgr(bgr);
}

/// image_transport compresses a Bayer pattern as a grey picture. Its format begins with the encoding.
bool holds_bayer_pattern(const CompressedImageMessage& image) {
  if (!image.format.starts_with("bayer_")) return false;
  const auto decoder = make_image_decoder(image.data);
  if (!decoder) return false;
  const auto header = (*decoder)->read_header();
  return header.ok() && header->num_channels == 1;
}

Result<Image<Rgb8>> decode_bayer_pattern(const Image<Rgb8>& grey, std::string_view format, std::string_view what) {
  std::string pattern;
  for (const Rgb8& c : grey.data()) pattern += static_cast<char>(c.r);
  ImageMessage image;
  image.encoding = format.substr(0, format.find(';'));
  image.width = image.row_bytes = static_cast<std::uint32_t>(grey.width());
  image.height = static_cast<std::uint32_t>(grey.height());
  image.data = pattern;
  return decode_raw_color(image, what);
}

/// Value (u, v) of a raw image, in the byte order of the message.
template <typename T>
T value_at(const ImageMessage& image, int u, int v) {
  char raw[sizeof(T)];
  std::memcpy(raw,
              image.data.data() + std::size_t{image.row_bytes} * static_cast<std::size_t>(v) +
                  sizeof(T) * static_cast<std::size_t>(u),
              sizeof(T));
  if (image.is_big_endian) std::reverse(raw, raw + sizeof(T));
  T value;
  std::memcpy(&value, raw, sizeof(T));
  return value;
}

constexpr double kMillimetre = 1e-3;

Result<Image<float>> decode_raw_depth(const ImageMessage& image, std::optional<double> metres_per_unit,
                                      std::string_view what) {
  const bool is_float = image.encoding == "32FC1";
  if (const auto done = check_size(image, is_float ? 4 : 2, what); !done) return done.error();
  const int width = static_cast<int>(image.width);
  const int height = static_cast<int>(image.height);
  if (!is_float) {
    Image<std::uint16_t> raw(width, height);
    for (int v = 0; v < height; ++v)
      for (int u = 0; u < width; ++u) raw(u, v) = value_at<std::uint16_t>(image, u, v);
    return scale_unsaturated_depth(raw, metres_per_unit.value_or(kMillimetre));
  }
  Image<float> depth_m(width, height);
  for (int v = 0; v < height; ++v)
    for (int u = 0; u < width; ++u)
      depth_m(u, v) = depth_or_none(value_at<float>(image, u, v) * metres_per_unit.value_or(1));
  return depth_m;
}

/// Some publishers leave the limits at 0.
Result<Image<float>> decode_disparity_depth(std::string_view bytes, const RecordedTopic& topic) {
  const auto message = decode_disparity(bytes, topic.layout, topic.name);
  if (!message) return message.error();
  const double unit = message->focal_length_px * message->baseline_m;
  if (message->image.encoding != "32FC1" || !(unit > 0) || !std::isfinite(unit))
    return Error{fmt::format(
        "{}: a disparity image without focal length or baseline, or of another encoding than 32FC1", topic.name)};
  auto depth_m = decode_raw_depth(message->image, 1, topic.name);
  if (!depth_m) return depth_m;
  const bool has_limits = message->max_disparity_px > message->min_disparity_px;
  for (float& value : depth_m->data()) {
    const bool is_measured =
        value > 0 && (!has_limits || (value >= message->min_disparity_px && value <= message->max_disparity_px));
    value = is_measured ? depth_or_none(unit / static_cast<double>(value)) : std::numeric_limits<float>::quiet_NaN();
  }
  return depth_m;
}

/// compressed_depth_image_transport: 12 bytes (a number and two parameters), then a PNG of 16 bits. Floating-point
/// metres are stored as a / (value - b).
Result<Image<float>> decode_compressed_depth(const CompressedImageMessage& image, std::optional<double> metres_per_unit,
                                             std::string_view what) {
  constexpr std::size_t kHeadBytes = 12;
  if (image.data.size() < kHeadBytes) return Error{fmt::format("{}: a message is cut off", what)};
  if (image.format.find("rvl") != std::string::npos)
    return Error{fmt::format("{}: depth compressed with RVL is not read (record with PNG)", what)};
  const auto raw = decode_depth_raw(image.data.substr(kHeadBytes), what);
  if (!raw) return raw.error();
  if (!image.format.starts_with("32FC1")) return scale_unsaturated_depth(*raw, metres_per_unit.value_or(kMillimetre));
  float a = 0;
  float b = 0;
  std::memcpy(&a, image.data.data() + 4, 4);
  std::memcpy(&b, image.data.data() + 8, 4);
  Image<float> depth_m(raw->width(), raw->height());
  for (std::size_t i = 0; i < raw->size(); ++i)
    depth_m[i] = depth_or_none(
        (*raw)[i] == 0 ? 0 : double{a} / (static_cast<double>((*raw)[i]) - double{b}) * metres_per_unit.value_or(1));
  return depth_m;
}

}  // namespace

ImageContent content_of(std::string_view encoding, std::string_view topic_name) {
  const std::string topic = to_lower(topic_name);
  if (encoding.find("compressedDepth") != encoding.npos) return ImageContent::kDepth;
  const bool is_png = encoding.find("png") != encoding.npos;
  if (encoding.starts_with("16UC1;")) return is_png ? ImageContent::kDepth : ImageContent::kUnknown;
  if (encoding == "16UC1" || encoding == "32FC1") return ImageContent::kDepth;
  if (encoding == "mono16") return topic.find("depth") != topic.npos ? ImageContent::kDepth : ImageContent::kUnknown;
  if (find_color_encoding(encoding) != nullptr) return ImageContent::kColor;
  const bool is_compressed = is_png || encoding.find("jp") != encoding.npos;
  const bool is_picture_of_depth = encoding.starts_with("32FC1") || encoding.starts_with("mono16");
  return is_compressed && !is_picture_of_depth ? ImageContent::kColor : ImageContent::kUnknown;
}

Result<Image<Rgb8>> decode_color_message(std::string_view bytes, const RecordedTopic& topic) {
  if (topic.type == "sensor_msgs/Image") {
    const auto image = decode_image(bytes, topic.layout, topic.name);
    if (!image) return image.error();
    return decode_raw_color(*image, topic.name);
  }
  const auto image = decode_compressed_image(bytes, topic.layout, topic.name);
  if (!image) return image.error();
  auto color = decode_color(image->data, topic.name, kMaxViewPixels);
  if (!color || !holds_bayer_pattern(*image)) return color;
  return decode_bayer_pattern(*color, image->format, topic.name);
}

Result<Image<float>> decode_depth_message(std::string_view bytes, const RecordedTopic& topic,
                                          std::optional<double> metres_per_unit) {
  if (topic.type == "sensor_msgs/Image") {
    const auto image = decode_image(bytes, topic.layout, topic.name);
    if (!image) return image.error();
    if (content_of(image->encoding, topic.name) != ImageContent::kDepth)
      return Error{fmt::format("{}: the encoding '{}' is no depth", topic.name, printable(image->encoding))};
    return decode_raw_depth(*image, metres_per_unit, topic.name);
  }
  if (topic.type == "stereo_msgs/DisparityImage") return decode_disparity_depth(bytes, topic);
  const auto image = decode_compressed_image(bytes, topic.layout, topic.name);
  if (!image) return image.error();
  if (image->format.find("compressedDepth") != std::string::npos)
    return decode_compressed_depth(*image, metres_per_unit, topic.name);
  const auto raw = decode_depth_raw(image->data, topic.name);
  if (!raw) return raw.error();
  return scale_unsaturated_depth(*raw, metres_per_unit.value_or(kMillimetre));
}

}  // namespace resight::io
