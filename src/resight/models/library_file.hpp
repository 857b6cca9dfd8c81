// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <filesystem>
#include <optional>

#include "resight/core/result.hpp"
#include "resight/models/object_model.hpp"

namespace resight {

/// Writes a library into one file: a header of 40 bytes (magic "RESIGHTM", format version, options hash, size and
/// checksum of the payload, little-endian) and a FlatBuffers payload (model_library.fbs). It appears under `path` only
/// when it is complete. The same library gives the same bytes. Descriptors take 8 bits a component, as in memory
/// (coded_features.hpp). At most 2 GB.
[[nodiscard]] Result<void> save_library(const ModelLibrary& library, const std::filesystem::path& path);

/// Reads a library. Damage, another kind or version of file, and (if `expected_options_hash` is given,
/// TrainOptions::hash()) training with other options are errors.
[[nodiscard]] Result<ModelLibrary> load_library(const std::filesystem::path& path,
                                                std::optional<std::uint64_t> expected_options_hash = std::nullopt);

}  // namespace resight
