// SPDX-License-Identifier: Apache-2.0
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <optional>

#include "resight/io/images.hpp"
#include "resight/io/internal/files.hpp"
#include "resight/io/internal/text.hpp"

namespace resight {
namespace {

static_assert(std::endian::native == std::endian::little, "the binary readers assume a little-endian machine");

struct NpyHeader {
  int width = 0;
  int height = 0;
  std::size_t data_offset = 0;
};

/// Parses the two numbers of "'shape': (480, 640)".
std::optional<std::pair<std::int64_t, std::int64_t>> parse_shape(std::string_view dictionary) {
  const std::size_t key = dictionary.find("'shape'");
  const std::size_t open = dictionary.find('(', key == dictionary.npos ? dictionary.size() : key);
  const std::size_t comma = dictionary.find(',', open == dictionary.npos ? dictionary.size() : open);
  const std::size_t close = dictionary.find(')', comma == dictionary.npos ? dictionary.size() : comma);
  if (close == dictionary.npos) return std::nullopt;
  io::TextCursor rows(dictionary.substr(open + 1, comma - open - 1));
  io::TextCursor columns(dictionary.substr(comma + 1, close - comma - 1));
  const auto height = io::parse_integer(rows.next());
  const auto width = io::parse_integer(columns.next());
  if (!height || !width || !columns.next().empty()) return std::nullopt;
  return std::pair{*height, *width};
}

std::optional<NpyHeader> parse_npy_header(std::string_view bytes) {
  if (bytes.size() < 12 || !bytes.starts_with("\x93NUMPY")) return std::nullopt;
  const bool version_1 = bytes[6] == 1;
  std::uint32_t length = 0;
  std::memcpy(&length, bytes.data() + 8, version_1 ? 2 : 4);
  const std::size_t begin = version_1 ? 10 : 12;
  if (length > bytes.size() - begin) return std::nullopt;
  const std::string_view dictionary = bytes.substr(begin, length);
  const bool float32 = dictionary.find("'<f4'") != dictionary.npos;
  const bool row_major = dictionary.find("'fortran_order': False") != dictionary.npos;
  const auto shape = parse_shape(dictionary);
  if (!float32 || !row_major || !shape || shape->first <= 0 || shape->second <= 0 || shape->first > kMaxImageSide_px ||
      shape->second > kMaxImageSide_px || shape->first * shape->second > kMaxViewPixels)
    return std::nullopt;
  return NpyHeader{static_cast<int>(shape->second), static_cast<int>(shape->first), begin + length};
}

}  // namespace

Result<Image<float>> read_depth_npy(const std::filesystem::path& file) {
  const auto bytes = io::read_file(file);
  if (!bytes) return bytes.error();
  const auto header = parse_npy_header(*bytes);
  if (!header)
    return io::file_error(file, "is not a supported NumPy array (expected '<f4', C order, shape (height, width))");
  const std::size_t num_pixels = static_cast<std::size_t>(header->width) * static_cast<std::size_t>(header->height);
  if (bytes->size() - header->data_offset < num_pixels * sizeof(float))
    return io::file_error(file, "is cut off: fewer values than its shape says");
  Image<float> depth_m(header->width, header->height);
  std::memcpy(depth_m.data().data(), bytes->data() + header->data_offset, num_pixels * sizeof(float));
  for (float& z : depth_m.data())
    if (!(z > 0 && std::isfinite(z))) z = std::numeric_limits<float>::quiet_NaN();
  return depth_m;
}

}  // namespace resight
