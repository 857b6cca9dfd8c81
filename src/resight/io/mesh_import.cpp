// SPDX-License-Identifier: Apache-2.0
#include <assimp/BaseImporter.h>
#include <assimp/config.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <algorithm>
#include <assimp/Importer.hpp>
#include <cmath>
#include <map>
#include <memory>
#include <string_view>

#include "resight/io/images.hpp"
#include "resight/io/internal/mesh_files.hpp"
#include "resight/io/internal/mesh_parts.hpp"

namespace resight::io {
namespace {

std::uint8_t to_channel(float value) {
  return std::isnan(value) ? std::uint8_t{0} : static_cast<std::uint8_t>(std::clamp(value * 255 + 0.5F, 0.0F, 255.0F));
}

Rgb8 to_color(const aiColor4D& c) { return {to_channel(c.r), to_channel(c.g), to_channel(c.b)}; }

/// The texture of a material as named in the file; empty if none.
std::string texture_name(const aiMaterial& material) {
  aiString name;
  for (const aiTextureType type : {aiTextureType_BASE_COLOR, aiTextureType_DIFFUSE})
    if (material.GetTexture(type, 0, &name) == aiReturn_SUCCESS && name.length > 0) break;
  std::string text = name.C_Str();
  while (!text.empty() && (text.back() == ' ' || text.back() == '\t' || text.back() == '\r')) text.pop_back();
  std::ranges::replace(text, '\\', '/');
  return text;
}

/// Loads each texture once. A texture that cannot be read gives a warning and an empty image.
class TextureLoader {
 public:
  TextureLoader(const aiScene& scene, const fs::path& file, std::vector<std::string>& warnings)
      : scene_(scene), file_(file), warnings_(warnings) {}

  Image<Rgb8>& load(const std::string& name) {
    const auto [it, is_new] = loaded_.try_emplace(name);
    if (!is_new) return it->second;
    auto texture = read(name);
    if (!texture) {
      warnings_.push_back(file_.string() + ": its texture is left out: " + texture.error().message);
      return it->second;
    }
    pixels_left_ -= static_cast<std::int64_t>(texture->size());
    it->second = std::move(*texture);
    return it->second;
  }

 private:
  /// Refuses what is larger than the pixels that are left before it is decoded.
  Result<Image<Rgb8>> read(const std::string& name) const {
    const aiTexture* embedded = scene_.GetEmbeddedTexture(name.c_str());
    if (embedded == nullptr) return read_texture(file_.parent_path(), name, pixels_left_);
    if (embedded->mHeight == 0)  // a compressed image of mWidth bytes
      return decode_color({reinterpret_cast<const char*>(embedded->pcData), embedded->mWidth},
                          file_.string() + " (texture)", pixels_left_);
    if (std::int64_t{embedded->mWidth} * embedded->mHeight > pixels_left_)
      return Error{file_.string() + " (texture): the image has more than " + std::to_string(pixels_left_) + " px"};
    Image<Rgb8> texture(static_cast<int>(embedded->mWidth), static_cast<int>(embedded->mHeight));
    for (std::size_t i = 0; i < texture.size(); ++i)
      texture[i] = {embedded->pcData[i].r, embedded->pcData[i].g, embedded->pcData[i].b};
    return texture;
  }

  const aiScene& scene_;
  const fs::path& file_;
  std::vector<std::string>& warnings_;
  std::map<std::string, Image<Rgb8>> loaded_;
  std::int64_t pixels_left_ = kMaxImagePixels;  ///< Small files can hold large images.
};

/// A part beside its texture, which other parts may have, too.
struct TexturedPart {
  MeshPart part;
  Image<Rgb8>* texture = nullptr;  ///< Of the loader; null: none.
};

TriangleMesh convert_geometry(const aiMesh& source) {
  TriangleMesh mesh;
  const auto vector3 = [](const aiVector3D& v) { return Eigen::Vector3f(v.x, v.y, v.z); };
  for (unsigned i = 0; i < source.mNumVertices; ++i) {
    mesh.vertices.push_back(vector3(source.mVertices[i]));
    if (source.HasNormals()) mesh.normals.push_back(vector3(source.mNormals[i]));
    // For all formats, Assimp has its origin at the bottom left.
    if (source.HasTextureCoords(0))
      mesh.uvs.push_back({source.mTextureCoords[0][i].x, 1 - source.mTextureCoords[0][i].y});
    if (source.HasVertexColors(0)) mesh.colors.push_back(to_color(source.mColors[0][i]));
  }
  for (unsigned i = 0; i < source.mNumFaces; ++i) {
    const aiFace& face = source.mFaces[i];
    if (face.mNumIndices != 3) continue;
    const auto in_range = [&](unsigned v) { return v < source.mNumVertices; };
    if (!in_range(face.mIndices[0]) || !in_range(face.mIndices[1]) || !in_range(face.mIndices[2])) continue;
    mesh.faces.push_back(
        {static_cast<int>(face.mIndices[0]), static_cast<int>(face.mIndices[1]), static_cast<int>(face.mIndices[2])});
  }
  return mesh;
}

/// Forgets the uniform colour of a part with a missing texture, because the texture would have covered it.
void forget_plain_color(MeshPart& part) {
  part.has_color = false;
  part.color = MeshPart{}.color;
  drop_plain_colors(part.mesh.colors);
}

TexturedPart convert_part(const aiMesh& source, const aiScene& scene, TextureLoader& textures) {
  TexturedPart converted;
  MeshPart& part = converted.part;
  part.mesh = convert_geometry(source);
  if (source.mMaterialIndex >= scene.mNumMaterials) return converted;
  const aiMaterial& material = *scene.mMaterials[source.mMaterialIndex];
  aiString material_name;
  material.Get(AI_MATKEY_NAME, material_name);
  aiColor4D color;
  // The default material of Assimp says nothing about the colour in the file.
  part.has_color = std::string(material_name.C_Str()) != AI_DEFAULT_MATERIAL_NAME &&
                   (material.Get(AI_MATKEY_BASE_COLOR, color) == aiReturn_SUCCESS ||
                    material.Get(AI_MATKEY_COLOR_DIFFUSE, color) == aiReturn_SUCCESS);
  if (part.has_color) part.color = to_color(color);
  const std::string name = texture_name(material);
  if (name.empty()) return converted;
  if (!part.mesh.uvs.empty())
    if (Image<Rgb8>& texture = textures.load(name); !texture.empty()) converted.texture = &texture;
  if (converted.texture != nullptr)
    part.mesh.colors.clear();
  else
    forget_plain_color(part);
  return converted;
}

/// Removes normals and uvs unless all parts have them, because they would be lost or wrong in the joined mesh.
void unify_attributes(std::vector<TexturedPart>& parts) {
  if (std::ranges::any_of(parts, [](const TexturedPart& p) { return p.part.mesh.normals.empty(); }))
    for (TexturedPart& part : parts) part.part.mesh.normals.clear();
  for (TexturedPart& part : parts)
    if (part.texture == nullptr) part.part.mesh.uvs.clear();
}

/// Merges parts with the same texture, so that a shared texture is neither copied nor stacked several times.
std::vector<MeshPart> merge_parts(std::vector<TexturedPart> parts) {
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

/// Removes all importers but that of this extension. Assimp would otherwise choose by the content, and parse any of its
/// fifty formats.
void keep_importer(Assimp::Importer& importer, std::string_view extension) {
  const std::string_view name = extension == "obj"   ? "Wavefront Object Importer"
                                : extension == "stl" ? "Stereolithography (STL) Importer"
                                                     : "glTF2 Importer";
  for (std::size_t i = importer.GetImporterCount(); i-- > 0;) {
    if (importer.GetImporterInfo(i)->mName == name) continue;
    const std::unique_ptr<Assimp::BaseImporter> removed(importer.GetImporter(i));
    importer.UnregisterLoader(removed.get());
  }
}

}  // namespace

Result<Image<Rgb8>> read_texture(const fs::path& folder, std::string_view name, std::int64_t max_pixels) {
  const auto file = path_below(folder, name);
  return file ? read_color(*file, max_pixels) : file.error();
}

Result<ImportedParts> import_mesh_parts(const fs::path& file) {
  auto files = MeshFiles::open(file);
  if (!files) return files.error();
  Assimp::Importer importer;
  keep_importer(importer, extension_of(file));
  const MeshFiles& opened = **files;
  importer.SetIOHandler(files->release());  // The importer owns it.
  importer.SetPropertyInteger(AI_CONFIG_PP_SBP_REMOVE, aiPrimitiveType_POINT | aiPrimitiveType_LINE);
  const aiScene* scene =
      importer.ReadFile(file.filename().string(), aiProcess_Triangulate | aiProcess_JoinIdenticalVertices |
                                                      aiProcess_SortByPType | aiProcess_PreTransformVertices);
  if (scene == nullptr) {
    std::string why = importer.GetErrorString();
    std::ranges::replace(why, '\n', ' ');
    if (!opened.failure().empty()) why += "; " + opened.failure();
    return file_error(file, "cannot be read as a mesh (" + why + ")");
  }
  ImportedParts imported;
  if (!opened.failure().empty())
    imported.warnings.push_back(file.string() + ": a file that it names is left out: " + opened.failure());
  TextureLoader textures(*scene, file, imported.warnings);
  std::vector<TexturedPart> parts;
  for (unsigned i = 0; i < scene->mNumMeshes; ++i) {
    TexturedPart part = convert_part(*scene->mMeshes[i], *scene, textures);
    if (!part.part.mesh.empty()) parts.push_back(std::move(part));
  }
  if (parts.empty()) return file_error(file, "has no triangles");
  unify_attributes(parts);
  imported.parts = merge_parts(std::move(parts));
  return imported;
}

}  // namespace resight::io
