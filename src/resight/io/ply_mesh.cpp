// SPDX-License-Identifier: Apache-2.0
#include "resight/io/internal/ply_mesh.hpp"

#include <algorithm>
#include <map>

#include "resight/io/internal/textured_parts.hpp"
#include "resight/io/ply.hpp"

namespace resight::io {
namespace {

using Faces = std::vector<std::array<int, 3>>;

/// Some faces of a mesh with their vertices, in the order of the mesh.
TriangleMesh copy_faces(const TriangleMesh& mesh, const Faces& faces) {
  std::vector<int> used;
  for (const auto& face : faces) used.insert(used.end(), face.begin(), face.end());
  std::ranges::sort(used);
  used.erase(std::unique(used.begin(), used.end()), used.end());
  TriangleMesh part;
  for (const int v : used) {
    part.vertices.push_back(mesh.vertices[v]);
    if (!mesh.normals.empty()) part.normals.push_back(mesh.normals[v]);
    if (!mesh.uvs.empty()) part.uvs.push_back(mesh.uvs[v]);
    if (!mesh.colors.empty()) part.colors.push_back(mesh.colors[v]);
  }
  const auto number_of = [&](int v) { return static_cast<int>(std::ranges::lower_bound(used, v) - used.begin()); };
  for (const auto& [a, b, c] : faces) part.faces.push_back({number_of(a), number_of(b), number_of(c)});
  return part;
}

std::vector<TexturedPart> split_by_texture(PlyContent content, TextureLoader& textures) {
  std::map<int, Faces> faces_of;
  for (std::size_t i = 0; i < content.mesh.faces.size(); ++i)
    faces_of[content.face_textures[i]].push_back(content.mesh.faces[i]);
  std::vector<TexturedPart> parts;
  for (const auto& [texture, faces] : faces_of) {
    TriangleMesh& mesh = parts.emplace_back().part.mesh;
    mesh = faces_of.size() == 1 ? std::move(content.mesh) : copy_faces(content.mesh, faces);
    if (texture < 0) mesh.uvs.clear();
    if (!content.texture_files.empty())
      set_material(parts.back(), std::nullopt, content.texture_files[static_cast<std::size_t>(std::max(texture, 0))],
                   textures);
  }
  return parts;
}

}  // namespace

Result<ImportedParts> import_ply(const fs::path& file) {
  auto content = read_ply(file);
  if (!content) return content.error();
  if (content->mesh.faces.empty()) return file_error(file, "has points but no faces; expected a mesh");
  ImportedParts imported;
  const auto read = [&](const std::string& name, std::int64_t max_pixels) {
    return read_texture(file.parent_path(), name, max_pixels);
  };
  TextureLoader textures(file, read, imported.warnings);
  auto merged = merge_parts(split_by_texture(*std::move(content), textures), file);
  if (!merged) return merged.error();
  imported.parts = *std::move(merged);
  return imported;
}

}  // namespace resight::io
