// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <cstdint>
#include <cstring>

#include "reader.hpp"
#include "resight/core/crc32.hpp"
#include "resight/io/images.hpp"
#include "resight/io/internal/depth_arrays.hpp"
#include "resight/io/internal/image_decoder.hpp"
#include "resight/io/internal/recording_images.hpp"
#include "resight/recordings/message.hpp"
#include "resight/recordings/testing/ros1_messages.hpp"

namespace resight::fuzz {
namespace {

namespace fs = std::filesystem;

constexpr std::int64_t kMaxFuzzPixels = 1 << 18;

Image<Rgb8> make_color() {
  Image<Rgb8> color(7, 5);
  for (std::size_t i = 0; i < color.size(); ++i) color[i] = {static_cast<std::uint8_t>(7 * i), 100, 3};
  return color;
}

std::vector<std::string> make_image_seeds() {
  return {bytes_written_by("seed.png", [](const fs::path& file) { (void)write_color(file, make_color()); }),
          bytes_written_by("seed.jpg", [](const fs::path& file) { (void)write_color(file, make_color()); }),
          bytes_written_by("seed.png",
                           [](const fs::path& file) { (void)write_depth(file, Image<float>(7, 5, 1.5F), 1e-3); }),
          bytes_written_by("seed.png",
                           [](const fs::path& file) { (void)write_mask(file, Image<std::uint8_t>(7, 5, 255)); })};
}

std::uint32_t big_endian_at(const std::string& bytes, std::size_t at) {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < 4; ++i) value = value << 8 | static_cast<unsigned char>(bytes[at + i]);
  return value;
}

/// Corrects the checksums of a PNG, so that its decoder sees what was changed.
std::string with_checksums(std::string_view bytes) {
  std::string png(bytes);
  if (!png.starts_with("\x89PNG\r\n\x1a\n")) return png;
  for (std::size_t at = 8; png.size() - at >= 12;) {
    const std::size_t length = big_endian_at(png, at);
    if (length > png.size() - at - 12) break;
    const std::uint32_t crc = compute_crc32(std::string_view(png).substr(at + 4, length + 4));
    for (std::size_t i = 0; i < 4; ++i) png[at + 8 + length + i] = static_cast<char>(crc >> (24 - 8 * i));
    at += length + 12;
  }
  return png;
}

Result<io::ImageHeader> read_header(std::string_view bytes) {
  const auto decoder = io::make_image_decoder(bytes);
  if (!decoder) return decoder.error();
  return (*decoder)->read_header();
}

/// Large images are valid, but slow.
bool is_large(std::int64_t width, std::int64_t height) {
  return width > 0 && height > 0 && height > kMaxFuzzPixels / width;
}

void decode(std::string_view bytes) {
  const std::string image = with_checksums(bytes);
  const auto header = read_header(image);
  if (header && is_large(header->width, header->height)) return;
  (void)decode_color(image, "fuzz.png", kMaxFuzzPixels);
  (void)decode_depth_raw(image, "fuzz.png");
}

std::vector<std::string> make_npy_seeds() {
  const auto npy = [](const std::string& dictionary, std::size_t num_bytes) {
    return std::string("\x93NUMPY\1\0", 8) + static_cast<char>(dictionary.size()) + '\0' + dictionary +
           std::string(num_bytes, '\x3f');
  };
  return {npy("{'descr': '<f4', 'fortran_order': False, 'shape': (3, 4), }\n", 48),
          npy("{'descr': '<u2', 'fortran_order': False, 'shape': (2, 2, 1), }\n", 8),
          npy("{'descr': '<f8', 'fortran_order': False, 'shape': (1, 1), }\n", 8)};
}

std::vector<std::string> stored_depth(const std::vector<std::string>& names) {
  std::vector<std::string> seeds;
  for (const std::string& name : names) seeds.push_back(source_file("tests/data/depth/" + name));
  return seeds;
}

void read_npy(std::string_view bytes) {
  const fs::path file = write_scratch("depth.npy", bytes);
  (void)read_depth_npy(file);
  (void)read_depth_npy(file, 0.001);
}

void read_exr(std::string_view bytes) {
  constexpr std::string_view kWindow("dataWindow\0box2i\0\x10\0\0\0", 21);
  std::array<std::int32_t, 4> window{};
  const std::size_t at = bytes.find(kWindow);
  if (at != bytes.npos && bytes.size() - at >= kWindow.size() + sizeof(window))
    std::memcpy(window.data(), bytes.data() + at + kWindow.size(), sizeof(window));
  if (is_large(std::int64_t{window[2]} - window[0] + 1, std::int64_t{window[3]} - window[1] + 1)) return;
  (void)io::parse_depth_exr(bytes, "fuzz.exr", std::nullopt);
}

/// The first byte chooses type and layout of the message.
std::vector<std::string> make_image_message_seeds() {
  std::vector<std::string> seeds;
  const auto raw = [](const char* encoding, std::size_t pixel_bytes) {
    return recordings::image_message(1.5, "camera", encoding, 4, 2, std::string(8 * pixel_bytes, '\x20'));
  };
  for (const char* encoding : {"rgb8", "bgr8"}) seeds.push_back('\0' + raw(encoding, 3));
  for (const char* encoding : {"mono8", "bayer_rggb8"}) seeds.push_back('\0' + raw(encoding, 1));
  for (const char* encoding : {"16UC1", "mono16", "yuv422"}) seeds.push_back('\0' + raw(encoding, 2));
  seeds.push_back('\0' + raw("32FC1", 4));
  const std::string png = bytes_written_by(
      "seed.png", [](const fs::path& file) { (void)write_depth(file, Image<float>(7, 5, 1.5F), 1e-3); });
  const auto compressed = [](const std::string& format, const std::string& data) {
    return '\2' + recordings::packed_header(1, "camera") + recordings::packed_text(format) +
           recordings::packed_text(data);
  };
  seeds.push_back(compressed("png", png));
  seeds.push_back(compressed("16UC1; compressedDepth png", std::string(12, '\0') + png));
  seeds.push_back(compressed("32FC1; compressedDepth png", std::string(12, '\1') + png));
  seeds.push_back('\4' + recordings::disparity_message(1.5, "camera", 500, 0.1F, 4, 2, std::string(32, '\x41')));
  return seeds;
}

void read_image_message(std::string_view bytes) {
  if (bytes.empty()) return;
  const char* const type = (bytes[0] & 4) != 0   ? "stereo_msgs/DisparityImage"
                           : (bytes[0] & 2) != 0 ? "sensor_msgs/CompressedImage"
                                                 : "sensor_msgs/Image";
  const RecordedTopic topic{"/camera/depth/image", type,
                            (bytes[0] & 1) != 0 ? MessageLayout::kCdr : MessageLayout::kRos1};
  bytes.remove_prefix(1);
  (void)io::decode_color_message(bytes, topic);
  (void)io::decode_depth_message(bytes, topic, std::nullopt);
  (void)decode_image_start(bytes, topic);
}

}  // namespace

std::vector<FuzzReader> image_readers() {
  return {
      {"image_header", make_image_seeds, [](std::string_view bytes) { (void)read_header(bytes); }},
      {"image", make_image_seeds, decode, 2000},
      {"npy", make_npy_seeds, read_npy},
      {"npz",
       [] {
         return stored_depth({"single.npz", "named.npz"});
       },
       [](std::string_view bytes) { (void)io::parse_depth_npz(bytes, "fuzz.npz", std::nullopt); }},
      {"exr",
       [] {
         return stored_depth({"single.exr", "half.exr"});
       },
       read_exr, 1000},
      {"image_message", make_image_message_seeds, read_image_message},
  };
}

}  // namespace resight::fuzz
