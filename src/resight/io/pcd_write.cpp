// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <lzf.h>

#include <bit>
#include <cstring>
#include <iterator>
#include <limits>

#include "resight/core/check.hpp"
#include "resight/io/internal/files.hpp"
#include "resight/io/pcd.hpp"

namespace resight {
namespace {

std::uint32_t pack(Rgb8 c) {
  return static_cast<std::uint32_t>(c.r) << 16 | static_cast<std::uint32_t>(c.g) << 8 | c.b;
}

/// Fields in the order x y z, rgb, normals as bit patterns. Each value has four bytes.
std::vector<std::vector<std::uint32_t>> make_columns(const PcdCloud& cloud) {
  std::vector<std::vector<std::uint32_t>> columns;
  const auto add_vectors = [&](const std::vector<Eigen::Vector3f>& vectors) {
    for (int k = 0; k < 3; ++k) {
      auto& column = columns.emplace_back(vectors.size());
      for (std::size_t i = 0; i < vectors.size(); ++i) column[i] = std::bit_cast<std::uint32_t>(vectors[i][k]);
    }
  };
  add_vectors(cloud.points);
  if (!cloud.colors.empty()) {
    auto& column = columns.emplace_back(cloud.colors.size());
    for (std::size_t i = 0; i < cloud.colors.size(); ++i) column[i] = pack(cloud.colors[i]);
  }
  if (!cloud.normals.empty()) add_vectors(cloud.normals);
  return columns;
}

std::string make_pcd_header(const PcdCloud& cloud, PcdEncoding encoding) {
  const bool color = !cloud.colors.empty();
  const bool normal = !cloud.normals.empty();
  // PCL expects rgb as a packed float. A float would lose it as text, so ascii files store a whole number.
  const std::string_view color_type = encoding == PcdEncoding::kAscii ? " U" : " F";
  const auto line = [&](std::string_view key, std::string_view xyz, std::string_view rgb, std::string_view normals) {
    return fmt::format("{} {}{}{}\n", key, xyz, color ? rgb : "", normal ? normals : "");
  };
  std::string header = "# .PCD v0.7 - Point Cloud Data file format\n";
  if (cloud.camera)
    header +=
        fmt::format("# camera {} {} {} {}\n", cloud.camera->fx, cloud.camera->fy, cloud.camera->cx, cloud.camera->cy);
  header += "VERSION 0.7\n";
  header += line("FIELDS", "x y z", " rgb", " normal_x normal_y normal_z");
  header += line("SIZE", "4 4 4", " 4", " 4 4 4");
  header += line("TYPE", "F F F", color_type, " F F F");
  header += line("COUNT", "1 1 1", " 1", " 1 1 1");
  const Eigen::Quaterniond q(cloud.viewpoint.rotation);
  const Eigen::Vector3d& t = cloud.viewpoint.translation;
  header += fmt::format("WIDTH {}\nHEIGHT {}\nVIEWPOINT {} {} {} {} {} {} {}\nPOINTS {}\n", cloud.width, cloud.height,
                        t.x(), t.y(), t.z(), q.w(), q.x(), q.y(), q.z(), cloud.points.size());
  constexpr std::string_view kNames[] = {"ascii", "binary", "binary_compressed"};
  return header + fmt::format("DATA {}\n", kNames[static_cast<int>(encoding)]);
}

void append_ascii(std::string& bytes, const PcdCloud& cloud) {
  auto out = std::back_inserter(bytes);
  const auto append = [&](const Eigen::Vector3f& v) { fmt::format_to(out, "{} {} {}", v.x(), v.y(), v.z()); };
  for (std::size_t i = 0; i < cloud.points.size(); ++i) {
    append(cloud.points[i]);
    if (!cloud.colors.empty()) fmt::format_to(out, " {}", pack(cloud.colors[i]));
    if (!cloud.normals.empty()) {
      bytes += ' ';
      append(cloud.normals[i]);
    }
    bytes += '\n';
  }
}

void append_binary(std::string& bytes, const std::vector<std::vector<std::uint32_t>>& columns, std::size_t num_points) {
  const std::size_t begin = bytes.size();
  bytes.resize(begin + 4 * columns.size() * num_points);
  char* target = bytes.data() + begin;
  for (std::size_t i = 0; i < num_points; ++i)
    for (const auto& column : columns) {
      std::memcpy(target, &column[i], 4);
      target += 4;
    }
}

bool append_compressed(std::string& bytes, const std::vector<std::vector<std::uint32_t>>& columns,
                       std::size_t num_points) {
  std::string plain;
  plain.reserve(4 * columns.size() * num_points);
  for (const auto& column : columns) plain.append(reinterpret_cast<const char*>(column.data()), 4 * column.size());
  if (plain.size() > std::numeric_limits<std::uint32_t>::max() / 2) return false;
  std::string packed(plain.size() + plain.size() / 16 + 64, '\0');  // LZF expands incompressible data by 1/32
  const std::uint32_t sizes[2] = {plain.empty() ? 0
                                                : lzf_compress(plain.data(), static_cast<unsigned>(plain.size()),
                                                               packed.data(), static_cast<unsigned>(packed.size())),
                                  static_cast<std::uint32_t>(plain.size())};
  if (sizes[0] == 0 && !plain.empty()) return false;
  bytes.append(reinterpret_cast<const char*>(sizes), sizeof(sizes));
  bytes.append(packed, 0, sizes[0]);
  return true;
}

}  // namespace

Result<void> write_pcd(const std::filesystem::path& file, const PcdCloud& cloud, PcdEncoding encoding) {
  const auto fits = [&](std::size_t size) { return size == 0 || size == cloud.points.size(); };
  require(cloud.width >= 0 && cloud.height >= 0 &&
              cloud.points.size() == static_cast<std::size_t>(cloud.width) * static_cast<std::size_t>(cloud.height),
          "write_pcd: width x height must be the number of points");
  require(fits(cloud.normals.size()) && fits(cloud.colors.size()),
          "write_pcd: an attribute must have one entry per point");
  require(cloud.viewpoint.is_rigid(), "write_pcd: the viewpoint is not rigid");
  std::string bytes = make_pcd_header(cloud, encoding);
  if (encoding == PcdEncoding::kAscii) {
    append_ascii(bytes, cloud);
  } else {
    const auto columns = make_columns(cloud);
    if (encoding == PcdEncoding::kBinary)
      append_binary(bytes, columns, cloud.points.size());
    else if (!append_compressed(bytes, columns, cloud.points.size()))
      return io::file_error(file, "the cloud is too large for binary_compressed");
  }
  return io::write_file(file, bytes);
}

}  // namespace resight
