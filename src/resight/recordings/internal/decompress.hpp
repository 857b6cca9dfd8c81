// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <string>
#include <string_view>

#include "resight/core/result.hpp"

namespace resight::recordings {

/// Decompresses a chunk of "lz4" (frame format), "bz2" or "zstd" to exactly `size` bytes, at most kMaxChunkBytes.
/// Fails for other compressions, damaged data and another size. The error does not name the file.
[[nodiscard]] Result<std::string> decompress(std::string_view compression, std::string_view bytes, std::uint64_t size);

/// The first `max_bytes` of what zstd has compressed, or all of it.
[[nodiscard]] Result<std::string> decompress_start(std::string_view bytes, std::size_t max_bytes);

}  // namespace resight::recordings
