// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <optional>
#include <string_view>

#include "resight/core/image.hpp"
#include "resight/core/result.hpp"

namespace resight::io {

/// Whether files of this extension (lower case) hold depth as numbers of their own type: npy, npz, exr.
[[nodiscard]] bool holds_depth_array(std::string_view extension);

/// Reads depth from a file of such an extension: floating-point metres, or any numbers times `metres_per_unit`. The
/// values pass depth_or_none().
[[nodiscard]] Result<Image<float>> read_depth_array(const std::filesystem::path& file,
                                                    std::optional<double> metres_per_unit);

/// The same for the bytes of a NumPy array, see read_depth_npy(). `name` is used in error messages.
[[nodiscard]] Result<Image<float>> parse_depth_npy(std::string_view bytes, std::string_view name,
                                                   std::optional<double> metres_per_unit);
/// Of an archive of NumPy arrays: its only array, or the one called depth.
[[nodiscard]] Result<Image<float>> parse_depth_npz(std::string_view bytes, std::string_view name,
                                                   std::optional<double> metres_per_unit);
/// Of an OpenEXR image: its only channel, or the one called Z, depth, Y, V or R.
[[nodiscard]] Result<Image<float>> parse_depth_exr(std::string_view bytes, std::string_view name,
                                                   std::optional<double> metres_per_unit);

}  // namespace resight::io
