// SPDX-License-Identifier: Apache-2.0
#include "resight/io/internal/textured_parts.hpp"

#include <algorithm>
#include <cmath>

#include "resight/core/srgb.hpp"

namespace resight::io {
namespace {

std::uint8_t to_byte(float value) {
  return std::isnan(value) ? std::uint8_t{0} : static_cast<std::uint8_t>(std::clamp(value * 255 + 0.5F, 0.0F, 255.0F));
}

void scale_light(Image<Rgb8>& image, const std::array<float, 3>& factors) {
  if (factors == std::array<float, 3>{1, 1, 1}) return;
  std::array<std::array<std::uint8_t, 256>, 3> scaled{};
  for (std::size_t k = 0; k < 3; ++k)
    for (std::size_t i = 0; i < 256; ++i)
      scaled[k][i] = to_byte(encode_srgb(decode_srgb(static_cast<float>(i)) * factors[k]) / 255);
  for (Rgb8& c : image.data()) c = {scaled[0][c.r], scaled[1][c.g], scaled[2][c.b]};
}

std::string to_file_name(std::string texture) {
  while (!texture.empty() && (texture.back() == ' ' || texture.back() == '\t' || texture.back() == '\r'))
    texture.pop_back();
  std::ranges::replace(texture, '\\', '/');
  return texture;
}

/// Forgets the uniform colour of a part with a missing texture, because the texture would have covered it.
void forget_plain_color(MeshPart& part) {
  part.has_color = false;
  part.color = MeshPart{}.color;
  std::vector<Rgb8>& colors = part.mesh.colors;
  if (std::ranges::all_of(colors, [&](const Rgb8& c) { return c == colors.front(); })) colors.clear();
}

/// Removes the normals unless all parts have them, and the uvs of parts without a texture: in the joined mesh, they
/// would be lost or wrong.
void unify_attributes(std::vector<TexturedPart>& parts) {
  if (std::ranges::any_of(parts, [](const TexturedPart& p) { return p.part.mesh.normals.empty(); }))
    for (TexturedPart& part : parts) part.part.mesh.normals.clear();
  for (TexturedPart& part : parts)
    if (part.texture == nullptr) part.part.mesh.uvs.clear();
}

}  // namespace

Image<Rgb8>& TextureLoader::load(const std::string& name, const std::array<float, 3>& light_factors) {
  const auto [it, is_new] = loaded_.try_emplace({name, light_factors});
  if (!is_new) return it->second;
  auto texture = read_(name, pixels_left_);
  if (!texture) {
    warn("its texture is left out: " + texture.error().message);
    return it->second;
  }
  pixels_left_ -= static_cast<std::int64_t>(texture->size());
  it->second = std::move(*texture);
  scale_light(it->second, light_factors);
  return it->second;
}

void TextureLoader::warn(const std::string& what) {
  if (said_.insert(what).second) warnings_.push_back(file_.string() + ": " + what);
}

Rgb8 to_color(float r, float g, float b) { return {to_byte(r), to_byte(g), to_byte(b)}; }

void set_material(TexturedPart& part, const std::optional<Rgb8>& color, std::string texture, TextureLoader& textures,
                  const std::array<float, 3>& light_factors) {
  MeshPart& bare = part.part;
  bare.has_color = color.has_value();
  if (color) bare.color = *color;
  const std::string name = to_file_name(std::move(texture));
  if (name.empty()) return;
  if (bare.mesh.uvs.empty())
    textures.warn("its texture is left out on faces without texture coordinates");
  else if (Image<Rgb8>& loaded = textures.load(name, light_factors); !loaded.empty())
    part.texture = &loaded;
  if (part.texture != nullptr)
    bare.mesh.colors.clear();
  else
    forget_plain_color(bare);
}

Result<std::vector<MeshPart>> merge_parts(std::vector<TexturedPart> parts, const fs::path& file) {
  std::erase_if(parts, [](const TexturedPart& part) { return part.part.mesh.empty(); });
  if (parts.empty()) return file_error(file, "has no triangles");
  unify_attributes(parts);
  std::vector<MeshPart> merged;
  std::map<const Image<Rgb8>*, std::size_t> part_of_texture;
  for (TexturedPart& part : parts) {
    const auto [it, is_new] = part_of_texture.try_emplace(part.texture, merged.size());
    if (part.texture != nullptr && !is_new) {
      merged[it->second].mesh.append(part.part.mesh);
      continue;
    }
    merged.push_back(std::move(part.part));
    if (part.texture != nullptr) merged.back().mesh.texture = std::move(*part.texture);
  }
  return merged;
}

Result<Image<Rgb8>> read_texture(const fs::path& folder, std::string_view name, std::int64_t max_pixels) {
  const auto file = path_below(folder, name);
  return file ? read_color(*file, max_pixels) : file.error();
}

}  // namespace resight::io
