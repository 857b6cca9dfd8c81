// SPDX-License-Identifier: Apache-2.0
#include "resight/io/internal/mesh_parts.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <tuple>

#include "resight/io/images.hpp"

namespace resight::io {
namespace {

constexpr int kSwatch_px = 4;  // size of a uniform colour as a texture; sufficient for bilinear sampling

/// The whole numbers by which the uvs of a face lie beyond [0, 1]; none if the texture repeats within the face.
std::optional<Eigen::Vector2f> find_shift(const TriangleMesh& mesh, const std::array<int, 3>& face) {
  constexpr float kSlack = 1e-3F;
  const Eigen::Vector2f& a = mesh.uvs[face[0]];
  const Eigen::Vector2f& b = mesh.uvs[face[1]];
  const Eigen::Vector2f& c = mesh.uvs[face[2]];
  const Eigen::Vector2f low = a.cwiseMin(b).cwiseMin(c);
  const Eigen::Vector2f high = a.cwiseMax(b).cwiseMax(c);
  Eigen::Vector2f shift = Eigen::Vector2f::Zero();
  for (int k = 0; k < 2; ++k)
    if (low[k] < -kSlack || high[k] > 1 + kSlack) shift[k] = std::floor(low[k] + kSlack);
  if ((high - shift).maxCoeff() > 1 + kSlack) return std::nullopt;
  return shift;
}

/// Moves the uvs of each face by whole numbers into [0, 1]. False if a texture repeats within a face.
bool move_into_image(TriangleMesh& mesh) {
  for (Eigen::Vector2f& uv : mesh.uvs)
    if (!uv.allFinite()) uv.setZero();
  bool any_moved = false;
  std::vector<CornerUvs> corner_uvs;
  for (const auto& face : mesh.faces) {
    const auto shift = find_shift(mesh, face);
    if (!shift) return false;
    any_moved = any_moved || !shift->isZero(0);
    corner_uvs.push_back({mesh.uvs[face[0]] - *shift, mesh.uvs[face[1]] - *shift, mesh.uvs[face[2]] - *shift});
  }
  if (any_moved) set_corner_uvs(mesh, corner_uvs);
  return true;
}

/// Nearest texel; uvs repeat. Those that are not finite count as 0.
Rgb8 sample(const Image<Rgb8>& texture, const Eigen::Vector2f& uv) {
  const auto texel = [](float x, int size) {
    const float fraction = x - std::floor(x);
    return fraction > 0 ? std::min(static_cast<int>(fraction * static_cast<float>(size)), size - 1) : 0;
  };
  return texture(texel(uv.x(), texture.width()), texel(uv.y(), texture.height()));
}

void bake_vertex_colors(MeshPart& part) {
  TriangleMesh& mesh = part.mesh;
  if (mesh.has_texture()) {
    mesh.colors.resize(mesh.vertices.size());
    for (std::size_t i = 0; i < mesh.vertices.size(); ++i) mesh.colors[i] = sample(mesh.texture, mesh.uvs[i]);
  } else if (mesh.colors.empty()) {
    mesh.colors.assign(mesh.vertices.size(), part.color);
  }
  mesh.texture = {};
  mesh.uvs.clear();
}

/// Stacks the textures of all parts (a swatch for parts without a texture) into one and adjusts the uvs.
void stack_textures(std::vector<MeshPart>& parts) {
  int width = 0;
  int height = 0;
  for (MeshPart& part : parts) {
    if (!part.mesh.has_texture()) {
      part.mesh.texture = Image<Rgb8>(kSwatch_px, kSwatch_px, part.color);
      part.mesh.uvs.assign(part.mesh.vertices.size(), Eigen::Vector2f(0.5F, 0.5F));
      part.mesh.colors.clear();
    }
    width = std::max(width, part.mesh.texture.width());
    height += part.mesh.texture.height();
  }
  Image<Rgb8> stacked(width, height);
  int top = 0;
  for (MeshPart& part : parts) {
    const Image<Rgb8>& texture = part.mesh.texture;
    for (int v = 0; v < texture.height(); ++v) std::ranges::copy(texture.row(v), stacked.row(top + v).begin());
    for (Eigen::Vector2f& uv : part.mesh.uvs) {
      // Half a texel inside, so that bilinear sampling does not reach the adjacent texture.
      const float x =
          std::clamp(uv.x() * static_cast<float>(texture.width()), 0.5F, static_cast<float>(texture.width()) - 0.5F);
      const float y =
          std::clamp(uv.y() * static_cast<float>(texture.height()), 0.5F, static_cast<float>(texture.height()) - 0.5F);
      uv = {x / static_cast<float>(width), (static_cast<float>(top) + y) / static_cast<float>(height)};
    }
    top += texture.height();
    part.mesh.texture = {};
  }
  parts.front().mesh.texture = std::move(stacked);
}

bool stack_fits(const std::vector<MeshPart>& parts) {
  std::int64_t width = 1;
  std::int64_t height = 0;
  for (const MeshPart& part : parts) {
    width = std::max<std::int64_t>(width, part.mesh.texture.width());
    height += std::max(kSwatch_px, part.mesh.texture.height());
  }
  return width * height <= kMaxImagePixels;
}

}  // namespace

void set_corner_uvs(TriangleMesh& mesh, std::span<const CornerUvs> corner_uvs) {
  std::map<std::tuple<int, float, float>, int> numbers;
  TriangleMesh split;
  for (std::size_t i = 0; i < mesh.faces.size(); ++i)
    for (std::size_t k = 0; k < 3; ++k) {
      const int old = mesh.faces[i][k];
      const Eigen::Vector2f uv = corner_uvs[i][k].allFinite() ? corner_uvs[i][k] : Eigen::Vector2f(0, 0);
      const auto [it, is_new] = numbers.try_emplace({old, uv.x(), uv.y()}, static_cast<int>(split.vertices.size()));
      if (is_new) {
        split.vertices.push_back(mesh.vertices[old]);
        split.uvs.push_back(uv);
        if (!mesh.normals.empty()) split.normals.push_back(mesh.normals[old]);
        if (!mesh.colors.empty()) split.colors.push_back(mesh.colors[old]);
      }
      mesh.faces[i][k] = it->second;
    }
  split.faces = std::move(mesh.faces);
  split.texture = std::move(mesh.texture);
  mesh = std::move(split);
}

JoinedMesh join_parts(std::vector<MeshPart> parts) {
  const auto is_textured = [](const MeshPart& part) { return part.mesh.has_texture(); };
  const auto is_colored = [](const MeshPart& part) { return part.has_color || !part.mesh.colors.empty(); };
  const bool any_texture = std::ranges::any_of(parts, is_textured);
  const bool mixed_colors =
      std::ranges::any_of(parts, [&](const MeshPart& p) { return !is_textured(p) && !p.mesh.colors.empty(); });
  const auto fits_image = [&](MeshPart& part) { return !is_textured(part) || move_into_image(part.mesh); };
  JoinedMesh joined;
  if (any_texture && parts.size() > 1) {
    if (mixed_colors)
      joined.loss = "other parts have such colours";
    else if (!std::ranges::all_of(parts, fits_image))
      joined.loss = "one of them repeats within a face";
    else if (!stack_fits(parts))
      joined.loss = "they are too large to become one";
    if (joined.loss.empty())
      stack_textures(parts);
    else
      for (MeshPart& part : parts) bake_vertex_colors(part);
  } else if (!any_texture) {
    const bool any_color = std::ranges::any_of(parts, is_colored);
    for (MeshPart& part : parts) {
      part.mesh.uvs.clear();
      if (any_color) bake_vertex_colors(part);
    }
  }
  TriangleMesh& whole = joined.mesh;
  whole = std::move(parts.front().mesh);
  Image<Rgb8> texture = std::move(whole.texture);
  whole.texture = {};
  for (std::size_t i = 1; i < parts.size(); ++i) whole.append(parts[i].mesh);
  whole.texture = std::move(texture);
  if (whole.has_texture()) whole.colors.clear();
  return joined;
}

}  // namespace resight::io
