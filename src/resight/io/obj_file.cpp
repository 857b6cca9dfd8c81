// SPDX-License-Identifier: Apache-2.0
#include "resight/io/internal/obj_file.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <map>

#include "resight/io/internal/mesh_files.hpp"
#include "resight/io/internal/obj_parser.hpp"
#include "resight/io/internal/polygon.hpp"
#include "resight/io/internal/textured_parts.hpp"

namespace resight::io {
namespace {

/// For each row, the number of the first one that is equal. Sorts, so that no input makes it slow.
template <std::size_t kSize>
std::vector<std::uint32_t> first_equal(const std::vector<std::array<std::uint32_t, kSize>>& rows) {
  struct Numbered {
    std::array<std::uint32_t, kSize> row;
    std::uint32_t number;
    auto operator<=>(const Numbered&) const = default;
  };
  std::vector<Numbered> sorted(rows.size());
  for (std::size_t i = 0; i < rows.size(); ++i) sorted[i] = {rows[i], static_cast<std::uint32_t>(i)};
  std::ranges::sort(sorted);
  std::vector<std::uint32_t> first(rows.size());
  for (std::size_t i = 0; i < sorted.size(); ++i) {
    const bool is_new = i == 0 || sorted[i].row != sorted[i - 1].row;
    first[sorted[i].number] = is_new ? sorted[i].number : first[sorted[i - 1].number];
  }
  return first;
}

/// Numbers that are equal have equal bits.
std::uint32_t bits_of(float value) { return std::bit_cast<std::uint32_t>(value + 0.0F); }

template <int kSize>
std::vector<std::array<std::uint32_t, kSize>> to_rows(const std::vector<Eigen::Matrix<float, kSize, 1>>& values) {
  std::vector<std::array<std::uint32_t, kSize>> rows(values.size());
  for (std::size_t i = 0; i < rows.size(); ++i)
    for (int k = 0; k < kSize; ++k) rows[i][static_cast<std::size_t>(k)] = bits_of(values[i][k]);
  return rows;
}

/// The positions with their colours, of which there may be none.
std::vector<std::array<std::uint32_t, 6>> to_vertex_rows(const ObjContent& content) {
  std::vector<std::array<std::uint32_t, 6>> rows(content.positions.size());
  for (std::size_t i = 0; i < rows.size(); ++i)
    for (int k = 0; k < 3; ++k) {
      rows[i][static_cast<std::size_t>(k)] = bits_of(content.positions[i][k]);
      rows[i][static_cast<std::size_t>(k) + 3] = content.colors.empty() ? 0 : bits_of(content.colors[i][k]);
    }
  return rows;
}

struct ObjPart {
  TriangleMesh mesh;
  int material = -1;  ///< -1: none.
  bool has_uvs = false;
};

/// Makes triangles with common vertices of the faces.
class ObjConverter {
 public:
  explicit ObjConverter(const ObjContent& content) : content_(content) {}

  std::vector<ObjPart> run() {
    has_normals_ = std::ranges::none_of(content_.corners, [](const ObjCorner& c) { return c.normal < 0; });
    first_position_ = first_equal(to_vertex_rows(content_));
    first_uv_ = first_equal(to_rows<2>(content_.uvs));
    if (has_normals_) first_normal_ = first_equal(to_rows<3>(content_.normals));
    std::size_t start = 0;
    for (const ObjFace& face : content_.faces) {
      const auto size = static_cast<std::size_t>(face.num_corners);
      add_face({content_.corners.data() + start, size}, face.material);
      start += size;
    }
    add_triangles();
    return std::move(parts_);
  }

 private:
  using Corner = std::array<std::uint32_t, 4>;  ///< Part, position, uv and normal; kNone: none.
  static constexpr std::uint32_t kNone = ~std::uint32_t{0};

  /// A part has one material, and uvs in all or none of its faces.
  std::uint32_t part_of(int material, bool has_uvs) {
    const auto [it, is_new] = part_of_.try_emplace({material, has_uvs}, static_cast<std::uint32_t>(parts_.size()));
    if (is_new) parts_.push_back({{}, material, has_uvs});
    return it->second;
  }

  void add_face(std::span<const ObjCorner> face, int material) {
    const bool has_uvs = std::ranges::any_of(face, [](const ObjCorner& c) { return c.uv >= 0; });
    const std::uint32_t part = part_of(material, has_uvs);
    const auto add = [&](int i) {
      const ObjCorner& corner = face[static_cast<std::size_t>(i)];
      corners_.push_back({part, first_position_[static_cast<std::size_t>(corner.position)],
                          corner.uv >= 0 ? first_uv_[static_cast<std::size_t>(corner.uv)] : kNone,
                          has_normals_ ? first_normal_[static_cast<std::size_t>(corner.normal)] : kNone});
    };
    if (face.size() == 3) {
      for (const int i : {0, 1, 2}) add(i);
      return;
    }
    polygon_.clear();
    for (const ObjCorner& corner : face)
      polygon_.push_back(content_.positions[static_cast<std::size_t>(corner.position)]);
    for (const std::array<int, 3>& triangle : triangulate(polygon_))
      for (const int i : triangle) add(i);
  }

  void add_triangles() {
    const std::vector<std::uint32_t> first = first_equal(corners_);
    std::vector<int> vertices(corners_.size());
    for (std::size_t i = 0; i < corners_.size(); ++i) {
      vertices[i] = first[i] == i ? add_vertex(corners_[i]) : vertices[first[i]];
      if (i % 3 == 2) parts_[corners_[i][0]].mesh.faces.push_back({vertices[i - 2], vertices[i - 1], vertices[i]});
    }
  }

  int add_vertex(const Corner& corner) {
    const auto [part, position, uv, normal] = corner;
    TriangleMesh& mesh = parts_[part].mesh;
    mesh.vertices.push_back(content_.positions[position]);
    if (has_normals_) mesh.normals.push_back(content_.normals[normal]);
    if (!content_.colors.empty()) {
      const Eigen::Vector3f& color = content_.colors[position];
      mesh.colors.push_back(to_color(color.x(), color.y(), color.z()));
    }
    if (parts_[part].has_uvs) {
      const Eigen::Vector2f up = uv == kNone ? Eigen::Vector2f::Zero() : content_.uvs[uv];
      mesh.uvs.emplace_back(up.x(), 1 - up.y());
    }
    return static_cast<int>(mesh.vertices.size()) - 1;
  }

  const ObjContent& content_;
  bool has_normals_ = false;
  std::vector<std::uint32_t> first_position_;
  std::vector<std::uint32_t> first_uv_;
  std::vector<std::uint32_t> first_normal_;
  std::map<std::pair<int, bool>, std::uint32_t> part_of_;
  std::vector<ObjPart> parts_;
  std::vector<Corner> corners_;  ///< Three of each triangle.
  std::vector<Eigen::Vector3f> polygon_;
};

/// Each library once: several names may lead to one file.
std::vector<MeshFiles::Bytes> read_libraries(std::span<const std::string> names, MeshFiles& files) {
  std::vector<MeshFiles::Bytes> libraries;
  for (const std::string& name : names)
    if (auto library = files.find(name); std::ranges::find(libraries, library) == libraries.end())
      libraries.push_back(std::move(library));
  return libraries;
}

std::vector<TexturedPart> add_materials(std::vector<ObjPart> parts, std::span<const ObjMaterial> materials,
                                        TextureLoader& textures) {
  std::vector<TexturedPart> result;
  for (ObjPart& part : parts) {
    TexturedPart& added = result.emplace_back();
    added.part.mesh = std::move(part.mesh);
    if (part.material < 0) continue;
    const ObjMaterial& material = materials[static_cast<std::size_t>(part.material)];
    set_material(added, material.color, material.texture, textures);
  }
  return result;
}

}  // namespace

Result<ImportedParts> import_obj(const fs::path& file) {
  auto bytes = read_file(file, kMaxBinaryBytes);
  if (!bytes) return bytes.error();
  auto content = parse_obj(*std::move(bytes));
  if (!content) return file_error(file, content.error().message);
  ImportedParts imported;
  MeshFiles files(file);
  define_materials(read_libraries(content->libraries, files), content->materials);
  files.add_warning(imported.warnings);
  const auto read = [&](const std::string& name, std::int64_t max_pixels) {
    return read_texture(file.parent_path(), name, max_pixels);
  };
  TextureLoader textures(file, read, imported.warnings);
  auto merged = merge_parts(add_materials(ObjConverter(*content).run(), content->materials, textures), file);
  if (!merged) return merged.error();
  imported.parts = *std::move(merged);
  return imported;
}

}  // namespace resight::io
