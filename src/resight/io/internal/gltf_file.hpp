// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <string_view>

#include "resight/core/result.hpp"
#include "resight/io/internal/gltf_uvs.hpp"

/// Assimp trusts glTF files: it recurses as deep as their nodes, follows numbers out of their buffers, and allocates
/// what they announce. It therefore gets only what we use, and that is checked.
namespace resight::io {

/// The name of each material. Assimp gives another one to parts without a material.
inline constexpr const char* kGltfMaterial = "material";
/// The file of the image of a texture that names none, or none that we read.
inline constexpr const char* kNoGltfImage = "no image";
/// The file of the buffer with the texture coordinates that we have computed.
inline constexpr const char* kGltfUvFile = "computed texture coordinates";

/// What Assimp gets of a glTF file.
struct NormalizedGltf {
  std::string bytes;  ///< In the form of the file, text or binary.
  std::string uvs;    ///< The content of kGltfUvFile.
};

/// The geometry and the base colours of a glTF 2.0 file: triangles with positions, normals, the first colours and the
/// texture coordinates of their material as floats (texture transforms are applied), in their nodes. Materials have a
/// factor and a texture with an image. Fails unless all of it lies within the buffers, and for what is not read:
/// compressed and sparse data, extensions that change more than the shading, and other versions.
[[nodiscard]] Result<NormalizedGltf> normalize_gltf(std::string_view text, const FindFile& find);
/// The same for the binary form.
[[nodiscard]] Result<NormalizedGltf> normalize_glb(std::string_view bytes, const FindFile& find);

}  // namespace resight::io
