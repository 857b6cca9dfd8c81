// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "resight/io/internal/files.hpp"
#include "resight/io/internal/mesh_parts.hpp"

namespace resight::io {

/// Imports an OBJ file with its material libraries.
[[nodiscard]] Result<ImportedParts> import_obj(const fs::path& file);

}  // namespace resight::io
