// SPDX-License-Identifier: Apache-2.0
#include <assimp/BaseImporter.h>
#include <assimp/MemoryIOWrapper.h>
#include <assimp/config.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <algorithm>
#include <assimp/IOSystem.hpp>
#include <assimp/Importer.hpp>
#include <memory>
#include <optional>
#include <set>
#include <string_view>

#include "resight/core/srgb.hpp"
#include "resight/io/images.hpp"
#include "resight/io/internal/gltf_file.hpp"
#include "resight/io/internal/mesh_files.hpp"
#include "resight/io/internal/mesh_parts.hpp"
#include "resight/io/internal/obj_file.hpp"
#include "resight/io/internal/ply_mesh.hpp"
#include "resight/io/internal/textured_parts.hpp"

namespace resight::io {
namespace {

/// Keeps the bytes alive as long as Assimp reads them.
class MeshStream final : public Assimp::MemoryIOStream {
 public:
  /// Is in `open` as long as it lives.
  MeshStream(MeshFiles::Bytes bytes, std::set<MeshStream*>& open)
      : MemoryIOStream(reinterpret_cast<const std::uint8_t*>(bytes->data()), bytes->size()),
        bytes_(std::move(bytes)),
        open_(open) {
    open_.insert(this);
  }
  ~MeshStream() override { open_.erase(this); }

 private:
  MeshFiles::Bytes bytes_;
  std::set<MeshStream*>& open_;
};

/// The files that Assimp may open. None is missing, because Assimp 5.2 reads beyond the end of some names of files that
/// do not exist: of "a://", "\\\\" and " " (FileSystemFilter::Cleanup()).
class AssimpFiles final : public Assimp::IOSystem {
 public:
  explicit AssimpFiles(MeshFiles& files) : files_(files) {}
  /// Assimp forgets a stream that is shorter than a glTF file says.
  ~AssimpFiles() override {
    while (!open_.empty()) delete *open_.begin();
  }

  bool Exists(const char* /*name*/) const override { return true; }
  char getOsSeparator() const override { return '/'; }
  Assimp::IOStream* Open(const char* name, const char* mode) override {
    return mode != nullptr && mode[0] == 'r' ? new MeshStream(files_.find(name), open_) : nullptr;
  }
  void Close(Assimp::IOStream* stream) override { delete stream; }

 private:
  MeshFiles& files_;
  std::set<MeshStream*> open_;
};

/// The texture of a material as named in the file; empty if none.
std::string texture_name(const aiMaterial& material) {
  aiString name;
  material.GetTexture(aiTextureType_BASE_COLOR, 0, &name);
  return name.C_Str();
}

/// Reads a texture from the scene or from a file of its own.
Result<Image<Rgb8>> read_scene_texture(const aiScene& scene, const fs::path& file, const std::string& name,
                                       std::int64_t max_pixels) {
  if (name == kNoGltfImage) return Error{"it names no image, or none that is read"};
  const aiTexture* embedded = scene.GetEmbeddedTexture(name.c_str());
  if (embedded == nullptr) return read_texture(file.parent_path(), name, max_pixels);
  if (embedded->mHeight == 0)  // a compressed image of mWidth bytes
    return decode_color({reinterpret_cast<const char*>(embedded->pcData), embedded->mWidth},
                        file.string() + " (texture)", max_pixels);
  if (std::int64_t{embedded->mWidth} * embedded->mHeight > max_pixels)
    return Error{file.string() + " (texture): the image has more than " + std::to_string(max_pixels) + " px"};
  Image<Rgb8> texture(static_cast<int>(embedded->mWidth), static_cast<int>(embedded->mHeight));
  for (std::size_t i = 0; i < texture.size(); ++i)
    texture[i] = {embedded->pcData[i].r, embedded->pcData[i].g, embedded->pcData[i].b};
  return texture;
}

/// glTF stores linear light, STL the curve of sRGB.
Rgb8 convert_color(const aiColor4D& c, bool is_linear) {
  return is_linear ? to_color(encode_srgb(c.r) / 255, encode_srgb(c.g) / 255, encode_srgb(c.b) / 255)
                   : to_color(c.r, c.g, c.b);
}

/// `factor`: on the colours of the vertices.
TriangleMesh convert_geometry(const aiMesh& source, const aiColor4D& factor, bool is_linear) {
  TriangleMesh mesh;
  const auto vector3 = [](const aiVector3D& v) { return Eigen::Vector3f(v.x, v.y, v.z); };
  for (unsigned i = 0; i < source.mNumVertices; ++i) {
    mesh.vertices.push_back(vector3(source.mVertices[i]));
    if (source.HasNormals()) mesh.normals.push_back(vector3(source.mNormals[i]));
    // For all formats, Assimp has its origin at the bottom left.
    if (source.HasTextureCoords(0))
      mesh.uvs.push_back({source.mTextureCoords[0][i].x, 1 - source.mTextureCoords[0][i].y});
    if (source.HasVertexColors(0)) mesh.colors.push_back(convert_color(source.mColors[0][i] * factor, is_linear));
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

/// The material of a glTF file, or null: STL has none, and Assimp gives one of its own to what has none.
const aiMaterial* find_material(const aiScene& scene, unsigned index) {
  aiString name;
  const bool is_ours = index < scene.mNumMaterials &&
                       scene.mMaterials[index]->Get(AI_MATKEY_NAME, name) == aiReturn_SUCCESS &&
                       std::string_view(name.C_Str()) == kGltfMaterial;
  return is_ours ? scene.mMaterials[index] : nullptr;
}

TexturedPart convert_part(const aiMesh& source, const aiScene& scene, bool is_gltf, TextureLoader& textures) {
  TexturedPart converted;
  const aiMaterial* material = find_material(scene, source.mMaterialIndex);
  aiColor4D factor(1, 1, 1, 1);
  if (material != nullptr) material->Get(AI_MATKEY_BASE_COLOR, factor);
  converted.part.mesh = convert_geometry(source, factor, is_gltf);
  if (material != nullptr)
    set_material(converted, convert_color(factor, is_gltf), texture_name(*material), textures,
                 {factor.r, factor.g, factor.b});
  return converted;
}

/// Removes all importers but that of this extension. Assimp would otherwise choose by the content, and parse any of its
/// fifty formats.
void keep_importer(Assimp::Importer& importer, std::string_view extension) {
  const std::string_view name = extension == "stl" ? "Stereolithography (STL) Importer" : "glTF2 Importer";
  for (std::size_t i = importer.GetImporterCount(); i-- > 0;) {
    if (importer.GetImporterInfo(i)->mName == name) continue;
    const std::unique_ptr<Assimp::BaseImporter> removed(importer.GetImporter(i));
    importer.UnregisterLoader(removed.get());
  }
}

/// Makes Assimp find the mesh file in a form that it may read.
Result<void> add_normalized(const fs::path& file, MeshFiles& files) {
  auto bytes = read_file(file, kMaxBinaryBytes);
  if (!bytes) return bytes.error();
  const std::string extension = extension_of(file);
  if (extension != "stl") {
    const auto find = [&](const std::string& name) { return files.find(name); };
    auto normalized = extension == "glb" ? normalize_glb(*bytes, find) : normalize_gltf(*bytes, find);
    if (!normalized) return file_error(file, normalized.error().message);
    *bytes = std::move(normalized->bytes);
    files.set(kGltfUvFile, std::move(normalized->uvs));
  }
  files.set(file.filename().string(), *std::move(bytes));
  return {};
}

std::string describe_failure(const Assimp::Importer& importer, const MeshFiles& files) {
  std::string why = importer.GetErrorString();
  std::ranges::replace(why, '\n', ' ');
  return files.failure().empty() ? why : why + "; " + files.failure();
}

Result<ImportedParts> import_with_assimp(const fs::path& file) {
  MeshFiles files(file);
  if (const auto done = add_normalized(file, files); !done) return done.error();
  Assimp::Importer importer;
  keep_importer(importer, extension_of(file));
  importer.SetIOHandler(new AssimpFiles(files));  // The importer owns it.
  importer.SetPropertyInteger(AI_CONFIG_PP_SBP_REMOVE, aiPrimitiveType_POINT | aiPrimitiveType_LINE);
  const aiScene* scene =
      importer.ReadFile(file.filename().string(), aiProcess_Triangulate | aiProcess_JoinIdenticalVertices |
                                                      aiProcess_SortByPType | aiProcess_PreTransformVertices);
  if (scene == nullptr) return file_error(file, "cannot be read as a mesh (" + describe_failure(importer, files) + ")");
  ImportedParts imported;
  files.add_warning(imported.warnings);
  const auto read = [&](const std::string& name, std::int64_t max_pixels) {
    return read_scene_texture(*scene, file, name, max_pixels);
  };
  TextureLoader textures(file, read, imported.warnings);
  std::vector<TexturedPart> parts;
  const bool is_gltf = extension_of(file) != "stl";
  for (unsigned i = 0; i < scene->mNumMeshes; ++i)
    parts.push_back(convert_part(*scene->mMeshes[i], *scene, is_gltf, textures));
  auto merged = merge_parts(std::move(parts), file);
  if (!merged) return merged.error();
  imported.parts = *std::move(merged);
  return imported;
}

}  // namespace

Result<ImportedParts> import_mesh_parts(const fs::path& file) {
  const std::string extension = extension_of(file);
  return extension == "ply" ? import_ply(file) : extension == "obj" ? import_obj(file) : import_with_assimp(file);
}

}  // namespace resight::io
