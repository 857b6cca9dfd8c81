// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "resight/io/internal/files.hpp"
#include "resight/io/internal/mesh_parts.hpp"
#include "resight/io/internal/ply_header.hpp"
#include "resight/io/internal/polygon.hpp"
#include "resight/io/ply.hpp"

namespace resight {
namespace {

using io::PlyElement;
using io::PlyHeader;
using io::PlyProperty;
using io::PlyType;

constexpr int kMaxListValues = 10000;

/// Column of the first of several names for the same property, or -1.
int find_first(const PlyElement& element, std::initializer_list<std::string_view> names) {
  for (const std::string_view name : names)
    if (const int i = element.find(name); i >= 0 && !element.properties[i].is_list) return i;
  return -1;
}

/// Columns of the attributes in a vertex row.
struct VertexColumns {
  explicit VertexColumns(const PlyElement& e)
      : position{find_first(e, {"x"}), find_first(e, {"y"}), find_first(e, {"z"})},
        normal{find_first(e, {"nx", "normal_x"}), find_first(e, {"ny", "normal_y"}), find_first(e, {"nz", "normal_z"})},
        color{find_first(e, {"red", "diffuse_red", "r"}), find_first(e, {"green", "diffuse_green", "g"}),
              find_first(e, {"blue", "diffuse_blue", "b"})},
        uv{find_first(e, {"texture_u", "u", "s", "tx"}), find_first(e, {"texture_v", "v", "t", "ty"})} {}

  template <typename Columns>
  static bool all(const Columns& columns) {
    return std::ranges::all_of(columns, [](int c) { return c >= 0; });
  }
  std::array<int, 3> position, normal, color;
  std::array<int, 2> uv;
};

std::uint8_t to_channel(double value, PlyType type) {
  if (type == PlyType::kFloat32 || type == PlyType::kFloat64) value *= 255;
  if (type == PlyType::kUint16) value /= 257;
  return std::isnan(value) ? std::uint8_t{0} : static_cast<std::uint8_t>(std::clamp(std::round(value), 0.0, 255.0));
}

Eigen::Vector2f to_top_left(double u, double v) { return {static_cast<float>(u), static_cast<float>(1 - v)}; }

class PlyReader {
 public:
  PlyReader(std::string_view bytes, const PlyHeader& header, std::string_view name)
      : header_(header), name_(name), values_(bytes.substr(header.body_offset), header.encoding) {}

  Result<PlyContent> read() {
    const auto place_of = [&](std::string_view name) {
      return std::ranges::find(header_.elements, name, &PlyElement::name);
    };
    // Polygons are cut by the places of their corners, so vertices are read first wherever they are.
    std::vector<std::vector<std::string_view>> passes = {{"vertex", "face"}};
    if (place_of("face") < place_of("vertex")) passes = {{"vertex"}, {"face"}};
    const io::PlyValueReader body = values_;
    for (const std::vector<std::string_view>& names : passes) {
      values_ = body;
      if (const auto done = read_elements(names); !done) return done.error();
    }
    if (mesh_.vertices.empty()) return fail("has no vertices");
    for (const auto& face : mesh_.faces)
      for (const int v : face)
        if (v < 0 || static_cast<std::size_t>(v) >= mesh_.vertices.size())
          return fail(fmt::format("a face refers to vertex {} of {}", v, mesh_.vertices.size()));
    if (corner_uvs_.size() == mesh_.faces.size() && !mesh_.faces.empty()) io::set_corner_uvs(mesh_, corner_uvs_);
    return PlyContent{std::move(mesh_), header_.texture_files, std::move(face_textures_)};
  }

 private:
  Error fail(std::string_view what) const { return Error{fmt::format("{}: {}", name_, what)}; }
  Error cut_off(const PlyElement& element) const {
    return fail(fmt::format("the data of '{}' end too early or are not numbers", element.name));
  }

  /// Reads the elements with these names, and skips the others.
  Result<void> read_elements(const std::vector<std::string_view>& names) {
    for (const PlyElement& element : header_.elements) {
      const bool is_wanted = std::ranges::find(names, element.name) != names.end();
      const auto done = !is_wanted                 ? skip(element)
                        : element.name == "vertex" ? read_vertices(element)
                                                   : read_faces(element);
      if (!done) return done.error();
    }
    return {};
  }

  /// Reads the values of a list, at most kMaxListValues.
  bool read_list(const PlyProperty& property, std::vector<double>& list) {
    double count = 0;
    if (!values_.next(property.count_type, count) || !(count >= 0 && count <= kMaxListValues) ||
        count != std::floor(count))
      return false;
    list.resize(static_cast<std::size_t>(count));
    return std::ranges::all_of(list, [&](double& value) { return values_.next(property.type, value); });
  }

  /// Reads one item: scalars to `row`, lists to `lists`, both by column.
  bool read_item(const PlyElement& element, std::vector<double>& row, std::vector<std::vector<double>>& lists) {
    for (std::size_t i = 0; i < element.properties.size(); ++i) {
      const PlyProperty& property = element.properties[i];
      if (property.is_list ? !read_list(property, lists[i]) : !values_.next(property.type, row[i])) return false;
    }
    return true;
  }

  Result<void> skip(const PlyElement& element) {
    std::vector<double> row(element.properties.size());
    std::vector<std::vector<double>> lists(element.properties.size());
    for (std::size_t i = 0; i < element.count; ++i)
      if (!read_item(element, row, lists)) return cut_off(element);
    return {};
  }

  Result<void> read_vertices(const PlyElement& element) {
    if (!mesh_.vertices.empty()) return fail("has two elements 'vertex'");
    const VertexColumns columns(element);
    if (!VertexColumns::all(columns.position)) return fail("its vertices have no x, y, z");
    const bool has_normal = VertexColumns::all(columns.normal);
    const bool has_color = VertexColumns::all(columns.color);
    const bool has_uv = VertexColumns::all(columns.uv);
    std::vector<double> row(element.properties.size());
    std::vector<std::vector<double>> lists(element.properties.size());
    const auto vector3 = [&](const std::array<int, 3>& c) {
      return Eigen::Vector3d(row[c[0]], row[c[1]], row[c[2]]).cast<float>().eval();
    };
    for (std::size_t i = 0; i < element.count; ++i) {
      if (!read_item(element, row, lists)) return cut_off(element);
      const Eigen::Vector3f point = vector3(columns.position);
      if (!point.allFinite()) return fail(fmt::format("vertex {} is not finite", i));
      mesh_.vertices.push_back(point);
      if (has_normal) {
        const Eigen::Vector3f n = vector3(columns.normal);
        const float norm = n.norm();
        mesh_.normals.push_back(std::isfinite(norm) && norm > 0 ? Eigen::Vector3f(n / norm) : Eigen::Vector3f::Zero());
      }
      if (has_color) {
        const auto channel = [&](int k) {
          return to_channel(row[columns.color[k]], element.properties[columns.color[k]].type);
        };
        mesh_.colors.push_back({channel(0), channel(1), channel(2)});
      }
      if (has_uv) mesh_.uvs.push_back(to_top_left(row[columns.uv[0]], row[columns.uv[1]]));
    }
    return {};
  }

  Result<void> read_faces(const PlyElement& element) {
    int indices = element.find("vertex_indices");
    if (indices < 0) indices = element.find("vertex_index");
    if (indices < 0 || !element.properties[indices].is_list) return fail("its faces have no list vertex_indices");
    const int texcoord = element.find("texcoord");
    const bool has_corner_uvs = mesh_.uvs.empty() && texcoord >= 0 && element.properties[texcoord].is_list;
    const int texnumber = find_first(element, {"texnumber"});
    std::vector<double> row(element.properties.size());
    std::vector<std::vector<double>> lists(element.properties.size());
    for (std::size_t i = 0; i < element.count; ++i) {
      if (!read_item(element, row, lists)) return cut_off(element);
      const std::vector<double>& polygon = lists[indices];
      for (const double v : polygon)
        if (!(v >= 0 && v <= INT32_MAX)) return fail(fmt::format("face {} refers to vertex {}", i, v));
      if (polygon.size() > io::kMaxPolygonCorners)
        return fail(fmt::format("has a face of more than {} corners", io::kMaxPolygonCorners));
      const double texture = texnumber >= 0 ? row[texnumber] : 0;
      const bool has_texture = texture >= 0 && texture < static_cast<double>(header_.texture_files.size());
      const bool has_uvs = !has_corner_uvs || lists[texcoord].size() == 2 * polygon.size();
      for (const auto& [a, b, c] : cut_into_triangles(polygon)) {
        mesh_.faces.push_back(
            {static_cast<int>(polygon[a]), static_cast<int>(polygon[b]), static_cast<int>(polygon[c])});
        face_textures_.push_back(has_texture && has_uvs ? static_cast<int>(texture) : -1);
        if (!has_corner_uvs) continue;
        const auto uv = [&](int k) -> Eigen::Vector2f {
          if (!has_uvs) return {0, 0};
          return to_top_left(lists[texcoord][2 * k], lists[texcoord][2 * k + 1]);
        };
        corner_uvs_.push_back({uv(a), uv(b), uv(c)});
      }
    }
    return {};
  }

  /// By the numbers of corners.
  std::vector<std::array<int, 3>> cut_into_triangles(const std::vector<double>& polygon) {
    if (polygon.size() < 3) return {};
    if (polygon.size() == 3) return {{0, 1, 2}};
    corners_.clear();
    for (const double v : polygon) {
      const auto i = static_cast<std::size_t>(v);
      corners_.push_back(i < mesh_.vertices.size() ? mesh_.vertices[i] : Eigen::Vector3f::Zero());
    }
    return io::triangulate(corners_);
  }

  const PlyHeader& header_;
  std::string_view name_;
  io::PlyValueReader values_;
  TriangleMesh mesh_;
  std::vector<Eigen::Vector3f> corners_;  ///< Of a face.
  std::vector<io::CornerUvs> corner_uvs_;
  std::vector<int> face_textures_;
};

}  // namespace

Result<PlyContent> parse_ply(std::string_view bytes, std::string_view name) {
  const auto header = io::parse_ply_header(bytes, name);
  if (!header) return header.error();
  return PlyReader(bytes, *header, name).read();
}

Result<PlyContent> read_ply(const std::filesystem::path& file) {
  const auto bytes = io::read_file(file, io::kMaxBinaryBytes);
  if (!bytes) return bytes.error();
  return parse_ply(*bytes, file.string());
}

Result<PointCloud> read_ply_cloud(const std::filesystem::path& file, double metres_per_unit) {
  auto content = read_ply(file);
  if (!content) return content.error();
  PointCloud cloud{std::move(content->mesh.vertices), std::move(content->mesh.normals),
                   std::move(content->mesh.colors)};
  if (metres_per_unit != 1.0)
    for (Eigen::Vector3f& p : cloud.points) p = (p.cast<double>() * metres_per_unit).cast<float>();
  return cloud;
}

}  // namespace resight
