// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "resight/io/internal/files.hpp"
#include "resight/io/internal/mesh_parts.hpp"

namespace resight::io {

/// Imports a PLY file with its textures.
[[nodiscard]] Result<ImportedParts> import_ply(const fs::path& file);

}  // namespace resight::io
