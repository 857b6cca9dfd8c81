// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <lzf.h>

#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>

#include "resight/io/internal/files.hpp"
#include "resight/io/internal/pcd_header.hpp"
#include "resight/io/internal/text.hpp"

namespace resight {
namespace {

using io::PcdField;
using io::PcdHeader;

/// LZF expands a block by a factor of at most 264 / 3. A header that claims a larger one is wrong.
constexpr std::size_t kMaxLzfRatio = 100;
constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

/// One field of all points of a binary body. The value of point i is at data + i * stride.
struct FieldColumn {
  const char* data = nullptr;
  std::size_t stride = 0;
  int size = 4;
  char type = 'F';
};

template <typename T>
T load(const char* bytes) {
  T value;
  std::memcpy(&value, bytes, sizeof(T));
  return value;
}

double load_value(const FieldColumn& column, std::size_t i) {
  const char* bytes = column.data + i * column.stride;
  if (column.type == 'F') return column.size == 8 ? load<double>(bytes) : load<float>(bytes);
  const bool is_signed = column.type == 'I';
  switch (column.size) {
    case 1:
      return is_signed ? load<std::int8_t>(bytes) : load<std::uint8_t>(bytes);
    case 2:
      return is_signed ? load<std::int16_t>(bytes) : load<std::uint16_t>(bytes);
    case 4:
      return is_signed ? load<std::int32_t>(bytes) : load<std::uint32_t>(bytes);
    default:
      return is_signed ? static_cast<double>(load<std::int64_t>(bytes))
                       : static_cast<double>(load<std::uint64_t>(bytes));
  }
}

Rgb8 unpack(std::uint32_t packed) {
  return {static_cast<std::uint8_t>(packed >> 16), static_cast<std::uint8_t>(packed >> 8),
          static_cast<std::uint8_t>(packed)};
}

/// The fields that are read; null if missing.
struct KnownFields {
  explicit KnownFields(const PcdHeader& header)
      : position{header.find("x"), header.find("y"), header.find("z")},
        normal{header.find("normal_x"), header.find("normal_y"), header.find("normal_z")},
        color(header.find("rgb") != nullptr ? header.find("rgb") : header.find("rgba")) {
    if (color != nullptr && color->size != 4) color = nullptr;
  }
  [[nodiscard]] bool has_position() const {
    return position[0] != nullptr && position[1] != nullptr && position[2] != nullptr;
  }
  [[nodiscard]] bool has_normal() const { return normal[0] != nullptr && normal[1] != nullptr && normal[2] != nullptr; }
  std::array<const PcdField*, 3> position, normal;
  const PcdField* color;
};

class BodyReader {
 public:
  BodyReader(const PcdHeader& header, std::string_view body, std::string_view name)
      : header_(header), known_(header), body_(body), name_(name), num_points_(header.num_points()) {}

  Result<PcdCloud> read() {
    if (!known_.has_position()) return fail("its FIELDS hold no x, y, z");
    const auto done = header_.encoding == PcdEncoding::kAscii    ? read_ascii()
                      : header_.encoding == PcdEncoding::kBinary ? read_binary()
                                                                 : read_compressed();
    if (!done) return done.error();
    cloud_.width = header_.width;
    cloud_.height = header_.height;
    cloud_.viewpoint = header_.viewpoint;
    cloud_.camera = header_.camera;
    return std::move(cloud_);
  }

 private:
  Error fail(std::string_view what) const { return Error{fmt::format("{}: {}", name_, what)}; }
  Error cut_off() const { return fail(fmt::format("is cut off: its header claims {} points", num_points_)); }

  void allocate() {
    cloud_.points.resize(num_points_);
    if (known_.has_normal()) cloud_.normals.resize(num_points_);
    if (known_.color != nullptr) cloud_.colors.resize(num_points_);
  }

  Result<void> read_ascii() {
    // A value takes at least two bytes; the separator after the last value may be missing.
    if (num_points_ > (body_.size() + 1) / (2 * header_.values_per_point)) return cut_off();
    allocate();
    io::TextCursor cursor(body_);
    std::vector<double> row(header_.values_per_point);
    for (std::size_t i = 0; i < num_points_; ++i) {
      for (double& value : row) {
        const std::string_view token = cursor.next();
        if (token.empty()) return cut_off();
        const auto number = io::parse_number(token);
        if (!number) return fail(fmt::format("point {} holds something that is no number", i));
        value = *number;
      }
      store_row(row, i);
    }
    return {};
  }

  void store_row(const std::vector<double>& row, std::size_t i) {
    const auto vector3 = [&](const std::array<const PcdField*, 3>& f) {
      return Eigen::Vector3d(row[f[0]->column], row[f[1]->column], row[f[2]->column]).cast<float>().eval();
    };
    cloud_.points[i] = vector3(known_.position);
    if (known_.has_normal()) cloud_.normals[i] = vector3(known_.normal);
    if (known_.color == nullptr) return;
    const double value = row[known_.color->column];
    if (known_.color->type == 'F')
      cloud_.colors[i] = unpack(std::bit_cast<std::uint32_t>(static_cast<float>(value)));
    else if (std::abs(value) < 4294967296.0)
      cloud_.colors[i] = unpack(static_cast<std::uint32_t>(static_cast<std::int64_t>(value)));
  }

  Result<void> read_binary() {
    if (num_points_ > body_.size() / header_.point_bytes) return cut_off();
    const auto column = [&](const PcdField& f) {
      return FieldColumn{body_.data() + f.offset, header_.point_bytes, f.size, f.type};
    };
    store_columns(column);
    return {};
  }

  /// Reads the sizes, then an LZF block with all values of the first field, then all of the second, and so on.
  Result<void> read_compressed() {
    if (body_.size() < 8) return cut_off();
    const std::size_t compressed = load<std::uint32_t>(body_.data());
    const std::size_t plain = load<std::uint32_t>(body_.data() + 4);
    if (compressed > body_.size() - 8) return cut_off();
    if (plain % header_.point_bytes != 0 || plain / header_.point_bytes != num_points_ ||
        plain > compressed * kMaxLzfRatio)
      return fail(fmt::format("its compressed block of {} bytes does not match {} points of {} bytes", plain,
                              num_points_, header_.point_bytes));
    std::string bytes(plain, '\0');
    if (plain > 0 && lzf_decompress(body_.data() + 8, static_cast<unsigned>(compressed), bytes.data(),
                                    static_cast<unsigned>(plain)) != plain)
      return fail("its compressed block is damaged (LZF)");
    const auto column = [&](const PcdField& f) {
      return FieldColumn{bytes.data() + f.offset * num_points_, f.bytes(), f.size, f.type};
    };
    store_columns(column);
    return {};
  }

  template <typename Column>
  void store_columns(const Column& column) {
    allocate();
    const auto store_vectors = [&](const std::array<const PcdField*, 3>& fields, std::vector<Eigen::Vector3f>& target) {
      for (int k = 0; k < 3; ++k) {
        const FieldColumn source = column(*fields[k]);
        for (std::size_t i = 0; i < num_points_; ++i) target[i][k] = static_cast<float>(load_value(source, i));
      }
    };
    store_vectors(known_.position, cloud_.points);
    if (known_.has_normal()) store_vectors(known_.normal, cloud_.normals);
    if (known_.color == nullptr) return;
    const FieldColumn source = column(*known_.color);
    for (std::size_t i = 0; i < num_points_; ++i)
      cloud_.colors[i] = unpack(load<std::uint32_t>(source.data + i * source.stride));
  }

  const PcdHeader& header_;
  KnownFields known_;
  std::string_view body_;
  std::string_view name_;
  std::size_t num_points_;
  PcdCloud cloud_;
};

}  // namespace

Result<PcdCloud> parse_pcd(std::string_view bytes, std::string_view name) {
  const auto header = io::parse_pcd_header(bytes, name);
  if (!header) return header.error();
  return BodyReader(*header, bytes.substr(header->body_offset), name).read();
}

Result<PcdCloud> read_pcd(const std::filesystem::path& file) {
  const auto bytes = io::read_file(file, io::kMaxBinaryBytes);
  if (!bytes) return bytes.error();
  return parse_pcd(*bytes, file.string());
}

Result<PcdSize> read_pcd_size(const std::filesystem::path& file) {
  const auto header = io::read_pcd_header(file);
  if (!header) return header.error();
  return PcdSize{header->width, header->height};
}

PointCloud to_point_cloud(const PcdCloud& cloud) {
  PointCloud result;
  const bool has_normals = cloud.normals.size() == cloud.points.size();
  const bool has_colors = cloud.colors.size() == cloud.points.size();
  for (std::size_t i = 0; i < cloud.points.size(); ++i) {
    if (!cloud.points[i].allFinite()) continue;
    result.points.push_back(cloud.points[i]);
    if (has_normals) result.normals.push_back(cloud.normals[i]);
    if (has_colors) result.colors.push_back(cloud.colors[i]);
  }
  return result;
}

PcdCloud to_pcd_cloud(const PointCloud& cloud) {
  PcdCloud pcd;
  pcd.width = static_cast<int>(cloud.size());
  pcd.height = 1;
  pcd.points = cloud.points;
  pcd.normals = cloud.normals;
  pcd.colors = cloud.colors;
  return pcd;
}

}  // namespace resight
