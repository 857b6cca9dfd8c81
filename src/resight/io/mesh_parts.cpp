// SPDX-License-Identifier: Apache-2.0
#include "resight/io/internal/mesh_parts.hpp"

#include <algorithm>
#include <cmath>

#include "resight/io/images.hpp"

namespace resight::io {
namespace {

constexpr int kSwatch_px = 4;  // size of a uniform colour as a texture; sufficient for bilinear sampling

bool has_plain_uvs(const TriangleMesh& mesh) {
  constexpr float kSlack = 1e-3F;
  return std::ranges::all_of(
      mesh.uvs, [](const Eigen::Vector2f& uv) { return uv.minCoeff() >= -kSlack && uv.maxCoeff() <= 1 + kSlack; });
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

TriangleMesh join_parts(std::vector<MeshPart> parts) {
  const auto is_textured = [](const MeshPart& part) { return part.mesh.has_texture(); };
  const auto is_colored = [](const MeshPart& part) { return part.has_color || !part.mesh.colors.empty(); };
  const bool any_texture = std::ranges::any_of(parts, is_textured);
  const bool mixed_colors =
      std::ranges::any_of(parts, [&](const MeshPart& p) { return !is_textured(p) && !p.mesh.colors.empty(); });
  const bool plain = std::ranges::all_of(parts, [](const MeshPart& p) { return has_plain_uvs(p.mesh); });
  if (any_texture && parts.size() > 1) {
    if (plain && !mixed_colors && stack_fits(parts))
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
  TriangleMesh whole = std::move(parts.front().mesh);
  Image<Rgb8> texture = std::move(whole.texture);
  whole.texture = {};
  for (std::size_t i = 1; i < parts.size(); ++i) whole.append(parts[i].mesh);
  whole.texture = std::move(texture);
  if (whole.has_texture()) whole.colors.clear();
  return whole;
}

}  // namespace resight::io
