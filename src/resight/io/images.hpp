// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string_view>

#include "resight/core/image.hpp"
#include "resight/core/result.hpp"

namespace resight {

/// Files with larger images are rejected before they are decoded.
inline constexpr int kMaxImageSide_px = 16384;
inline constexpr int kMaxImagePixels = 1 << 27;
/// Limit for the images of a view, of which several copies of 4 bytes and more per pixel are made.
inline constexpr int kMaxViewPixels = 1 << 24;

/// Reads a PNG or JPEG as 8-bit colour. Grey is copied to all three channels; alpha is dropped.
[[nodiscard]] Result<Image<Rgb8>> read_color(const std::filesystem::path& file,
                                             std::int64_t max_pixels = kMaxImagePixels);
/// Same for the bytes of a file. `name` is used in error messages.
[[nodiscard]] Result<Image<Rgb8>> decode_color(std::string_view bytes, std::string_view name,
                                               std::int64_t max_pixels = kMaxImagePixels);

/// Reads the stored values of an 8- or 16-bit PNG with one channel.
[[nodiscard]] Result<Image<std::uint16_t>> read_depth_raw(const std::filesystem::path& file);
/// Same for the bytes of a file. `name` is used in error messages.
[[nodiscard]] Result<Image<std::uint16_t>> decode_depth_raw(std::string_view bytes, std::string_view name);
/// Depth in metres from stored values. 0 becomes NaN, and so does 65535: cameras say by it that a surface is too far,
/// or mark missing depth (7-Scenes).
[[nodiscard]] Image<float> scale_unsaturated_depth(const Image<std::uint16_t>& raw, double metres_per_unit);
/// Reads depth in metres from a 16-bit PNG: stored value times `metres_per_unit`. A stored 0 becomes NaN, as
/// by depth_or_none(). 65535 is a depth: write_depth() writes it.
[[nodiscard]] Result<Image<float>> read_depth(const std::filesystem::path& file, double metres_per_unit);
/// Reads a NumPy array of shape (height, width): floating-point metres, or any numbers times `metres_per_unit`. Values
/// that are no depth (depth_or_none) become NaN. Whole numbers without a unit are refused.
[[nodiscard]] Result<Image<float>> read_depth_npy(const std::filesystem::path& file,
                                                  std::optional<double> metres_per_unit = {});
/// Reads an 8- or 16-bit PNG with one channel, or a colour PNG: 255 where it is not black, else 0.
[[nodiscard]] Result<Image<std::uint8_t>> read_mask(const std::filesystem::path& file);

/// Writes a PNG, or a JPEG (quality 95) for the extensions jpg and jpeg.
[[nodiscard]] Result<void> write_color(const std::filesystem::path& file, const Image<Rgb8>& color);
/// Writes a 16-bit PNG: depth / metres_per_unit rounded to the nearest integer, and NaN as 0. Fails for a depth that
/// does not fit: more than 65535 units, or positive but rounded to 0, which would become a hole.
[[nodiscard]] Result<void> write_depth(const std::filesystem::path& file, const Image<float>& depth_m,
                                       double metres_per_unit);
/// Writes an 8-bit PNG; 255 = set.
[[nodiscard]] Result<void> write_mask(const std::filesystem::path& file, const Image<std::uint8_t>& mask);

}  // namespace resight
