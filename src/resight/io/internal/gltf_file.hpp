// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <string_view>

#include "resight/core/result.hpp"

/// Assimp trusts glTF files: it recurses as deep as their nodes, follows numbers out of their buffers, and allocates
/// what they announce. It therefore gets only what we use, and that is checked.
namespace resight::io {

/// The geometry and the materials of a glTF 2.0 file: triangles with positions, normals, the first texture coordinates
/// and the first colours, in their nodes. Fails unless all of it lies within the buffers, and for what is not read:
/// compressed and sparse data, and other versions.
[[nodiscard]] Result<std::string> normalize_gltf(std::string_view text);
/// The same for the binary form.
[[nodiscard]] Result<std::string> normalize_glb(std::string_view bytes);

}  // namespace resight::io
