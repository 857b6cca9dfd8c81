// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>

#include "resight/sensor/sequence.hpp"

namespace resight::app {

/// How a file of write_fused_cloud() begins.
inline constexpr const char* kFusedSignature =
    "ply\nformat binary_little_endian 1.0\ncomment written by resight\ncomment all views of resight track\n";

/// Writes all views of a posed sequence (evenly sampled views of a long one) as one cloud (PLY, world frame, metres),
/// and next to it a picture (.png) from behind the cameras.
void write_fused_cloud(const Sequence& posed, const std::filesystem::path& file, int num_threads);

/// The file of the picture next to a cloud.
[[nodiscard]] std::filesystem::path picture_of_cloud(const std::filesystem::path& file);

}  // namespace resight::app
