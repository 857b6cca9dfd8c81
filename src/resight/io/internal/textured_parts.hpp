// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "resight/io/images.hpp"
#include "resight/io/internal/files.hpp"
#include "resight/io/internal/mesh_parts.hpp"

/// What the importers of mesh formats share.
namespace resight::io {

/// Reads a texture that a mesh in `folder` names. It must lie below the folder.
[[nodiscard]] Result<Image<Rgb8>> read_texture(const fs::path& folder, std::string_view name, std::int64_t max_pixels);

/// Loads each texture once. A texture that cannot be read gives a warning and an empty image.
class TextureLoader {
 public:
  /// Reads a texture by its name, and refuses what has more pixels before it is decoded.
  using Read = std::function<Result<Image<Rgb8>>(const std::string& name, std::int64_t max_pixels)>;
  TextureLoader(const fs::path& file, Read read, std::vector<std::string>& warnings)
      : file_(file), read_(std::move(read)), warnings_(warnings) {}

  /// `light_factors`: on the linear light of its channels.
  Image<Rgb8>& load(const std::string& name, const std::array<float, 3>& light_factors);
  /// Adds a warning, each once.
  void warn(const std::string& what);

 private:
  const fs::path& file_;
  Read read_;
  std::vector<std::string>& warnings_;
  std::set<std::string> said_;
  std::map<std::pair<std::string, std::array<float, 3>>, Image<Rgb8>> loaded_;
  std::int64_t pixels_left_ = kMaxImagePixels;  ///< Small files can hold large images.
};

/// A part beside its texture, which other parts may have, too.
struct TexturedPart {
  MeshPart part;
  Image<Rgb8>* texture = nullptr;  ///< Of the loader; null: none.
};

[[nodiscard]] Rgb8 to_color(float r, float g, float b);

/// The material of a part: its uniform colour, the name of its texture as the file has it (empty: none), and factors on
/// the linear light of the texture.
void set_material(TexturedPart& part, const std::optional<Rgb8>& color, std::string texture, TextureLoader& textures,
                  const std::array<float, 3>& light_factors = {1, 1, 1});

/// Parts with the same texture become one, so that it is neither copied nor stacked several times. Normals are kept if
/// all parts have them. Fails if no part has a triangle.
[[nodiscard]] Result<std::vector<MeshPart>> merge_parts(std::vector<TexturedPart> parts, const fs::path& file);

}  // namespace resight::io
