// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string_view>

#include "resight/core/result.hpp"
#include "resight/models/object_model.hpp"

namespace resight {

/// The first bytes of every library file.
inline constexpr std::string_view kLibrarySignature = "RESIGHTM";

/// Writes a library to one file: a header of 40 bytes (kLibrarySignature, format version, options hash, size and
/// checksum of the payload, little-endian) and a FlatBuffers payload (model_library.fbs). The file appears under `path`
/// only when it is complete. Equal libraries give equal bytes. Descriptors take 8 bits per component, as in memory
/// (coded_features.hpp). Fails above 2 GB, and for content that load_library() refuses.
[[nodiscard]] Result<void> save_library(const ModelLibrary& library, const std::filesystem::path& path);

/// Reads a library. Fails if the file is damaged, of another kind or version, or (if `expected_options_hash`, a
/// TrainOptions::hash(), is given) trained with other options.
[[nodiscard]] Result<ModelLibrary> load_library(const std::filesystem::path& path,
                                                std::optional<std::uint64_t> expected_options_hash = std::nullopt);

}  // namespace resight
