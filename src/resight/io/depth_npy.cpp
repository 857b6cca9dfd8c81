// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <optional>
#include <string>

#include "resight/io/images.hpp"
#include "resight/io/internal/depth_arrays.hpp"
#include "resight/io/internal/files.hpp"
#include "resight/io/internal/text.hpp"
#include "resight/sensor/rgbd_frame.hpp"

namespace resight {
namespace {

static_assert(std::endian::native == std::endian::little, "the binary readers assume a little-endian machine");

/// Types of numbers that depth is stored in.
enum class NpyType { kFloat16, kFloat32, kFloat64, kInt8, kUint8, kInt16, kUint16, kInt32, kUint32 };

struct NpyHeader {
  int width = 0;
  int height = 0;
  NpyType type = NpyType::kFloat32;
  bool is_column_major = false;
  std::size_t data_offset = 0;
};

struct NamedNpyType {
  std::string_view name;
  NpyType type;
};
constexpr std::array<NamedNpyType, 10> kNpyTypes = {{{"'<f2'", NpyType::kFloat16},
                                                     {"'<f4'", NpyType::kFloat32},
                                                     {"'<f8'", NpyType::kFloat64},
                                                     {"'|i1'", NpyType::kInt8},
                                                     {"'|u1'", NpyType::kUint8},
                                                     {"'<i2'", NpyType::kInt16},
                                                     {"'<u2'", NpyType::kUint16},
                                                     {"'<i4'", NpyType::kInt32},
                                                     {"'<u4'", NpyType::kUint32},
                                                     {"'|f4'", NpyType::kFloat32}}};

std::size_t bytes_of(NpyType type) {
  if (type == NpyType::kInt8 || type == NpyType::kUint8) return 1;
  if (type == NpyType::kInt16 || type == NpyType::kUint16 || type == NpyType::kFloat16) return 2;
  return type == NpyType::kFloat64 ? 8 : 4;
}

template <typename T>
double load_as(const char* bytes) {
  T value;
  std::memcpy(&value, bytes, sizeof(T));
  return static_cast<double>(value);
}

double load_value(NpyType type, const char* bytes) {
  switch (type) {
    case NpyType::kFloat16:
      return load_as<Eigen::half>(bytes);
    case NpyType::kFloat32:
      return load_as<float>(bytes);
    case NpyType::kFloat64:
      return load_as<double>(bytes);
    case NpyType::kInt8:
      return load_as<std::int8_t>(bytes);
    case NpyType::kUint8:
      return load_as<std::uint8_t>(bytes);
    case NpyType::kInt16:
      return load_as<std::int16_t>(bytes);
    case NpyType::kUint16:
      return load_as<std::uint16_t>(bytes);
    case NpyType::kInt32:
      return load_as<std::int32_t>(bytes);
    case NpyType::kUint32:
      break;
  }
  return load_as<std::uint32_t>(bytes);
}

/// Parses the two numbers of "'shape': (480, 640)".
std::optional<std::pair<std::int64_t, std::int64_t>> parse_shape(std::string_view dictionary) {
  const std::size_t key = dictionary.find("'shape'");
  const std::size_t open = dictionary.find('(', key == dictionary.npos ? dictionary.size() : key);
  const std::size_t comma = dictionary.find(',', open == dictionary.npos ? dictionary.size() : open);
  const std::size_t close = dictionary.find(')', comma == dictionary.npos ? dictionary.size() : comma);
  if (close == dictionary.npos) return std::nullopt;
  io::TextCursor rows(dictionary.substr(open + 1, comma - open - 1));
  std::string after_comma(dictionary.substr(comma + 1, close - comma - 1));
  std::ranges::replace(after_comma, ',', ' ');
  io::TextCursor columns(after_comma);
  const auto height = io::parse_integer(rows.next());
  const auto width = io::parse_integer(columns.next());
  const std::string_view channels = columns.next();  // a third dimension of one channel
  if (!height || !width || (!channels.empty() && channels != "1")) return std::nullopt;
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
  constexpr std::string_view kKey = "'descr': ";
  const std::size_t key = dictionary.find(kKey);
  if (key == dictionary.npos) return std::nullopt;
  const std::string_view description = dictionary.substr(key + kKey.size());
  const auto type =
      std::ranges::find_if(kNpyTypes, [&](const NamedNpyType& t) { return description.starts_with(t.name); });
  const bool is_column_major = dictionary.find("'fortran_order': True") != dictionary.npos;
  const auto shape = parse_shape(dictionary);
  if (type == kNpyTypes.end() || !shape || shape->first <= 0 || shape->second <= 0 || shape->first > kMaxImageSide_px ||
      shape->second > kMaxImageSide_px || shape->first * shape->second > kMaxViewPixels)
    return std::nullopt;
  return NpyHeader{static_cast<int>(shape->second), static_cast<int>(shape->first), type->type, is_column_major,
                   begin + length};
}

}  // namespace

Result<Image<float>> io::parse_depth_npy(std::string_view bytes, std::string_view name,
                                         std::optional<double> metres_per_unit) {
  const auto fail = [&](std::string_view what) { return Error{fmt::format("{}: {}", name, what)}; };
  const auto header = parse_npy_header(bytes);
  if (!header)
    return fail("is not a supported NumPy array (expected numbers such as '<f4', in a shape (height, width))");
  const bool is_float =
      header->type == NpyType::kFloat16 || header->type == NpyType::kFloat32 || header->type == NpyType::kFloat64;
  if (!is_float && !metres_per_unit)
    return fail(
        "holds whole numbers, whose unit is not known: give --depth-scale METRES per unit (0.001: millimetres)");
  const std::size_t num_pixels = static_cast<std::size_t>(header->width) * static_cast<std::size_t>(header->height);
  const std::size_t value_bytes = bytes_of(header->type);
  if (bytes.size() - header->data_offset < num_pixels * value_bytes)
    return fail("is cut off: fewer values than its shape says");
  Image<float> depth_m(header->width, header->height);
  const double scale = metres_per_unit.value_or(1);
  const char* value = bytes.data() + header->data_offset;
  for (std::size_t i = 0; i < num_pixels; ++i, value += value_bytes) {
    const auto height = static_cast<std::size_t>(header->height);
    const std::size_t pixel =
        header->is_column_major ? i % height * static_cast<std::size_t>(header->width) + i / height : i;
    depth_m[pixel] = depth_or_none(scale * load_value(header->type, value));
  }
  return depth_m;
}

bool io::holds_depth_array(std::string_view extension) {
  return extension == "npy" || extension == "npz" || extension == "exr";
}

Result<Image<float>> io::read_depth_array(const std::filesystem::path& file, std::optional<double> metres_per_unit) {
  const auto bytes = read_file(file);
  if (!bytes) return bytes.error();
  const std::string extension = extension_of(file);
  const auto parse = extension == "npz" ? parse_depth_npz : extension == "exr" ? parse_depth_exr : parse_depth_npy;
  return parse(*bytes, file.string(), metres_per_unit);
}

Result<Image<float>> read_depth_npy(const std::filesystem::path& file, std::optional<double> metres_per_unit) {
  const auto bytes = io::read_file(file);
  if (!bytes) return bytes.error();
  return io::parse_depth_npy(*bytes, file.string(), metres_per_unit);
}

}  // namespace resight
