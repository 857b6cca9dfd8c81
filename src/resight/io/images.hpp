// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <filesystem>
#include <string_view>

#include "resight/core/image.hpp"
#include "resight/core/result.hpp"

namespace resight {

/// A file of a larger image is refused before it is decoded.
inline constexpr int kMaxImageSide_px = 16384;
inline constexpr int kMaxImagePixels = 1 << 27;

/// A PNG or JPEG as 8-bit colour (grey is copied to the three channels, alpha is dropped).
[[nodiscard]] Result<Image<Rgb8>> read_color(const std::filesystem::path& file);
/// The same from the bytes of such a file; `name` is for messages.
[[nodiscard]] Result<Image<Rgb8>> decode_color(std::string_view bytes, std::string_view name);

/// The stored numbers of an 8- or 16-bit PNG of one channel.
[[nodiscard]] Result<Image<std::uint16_t>> read_depth_raw(const std::filesystem::path& file);
/// Depth in metres of a 16-bit PNG, stored value times `metres_per_unit`; stored 0 = no return = NaN.
[[nodiscard]] Result<Image<float>> read_depth(const std::filesystem::path& file, double metres_per_unit);
/// float32 of a NumPy file of shape (height, width), in metres; anything not positive and finite becomes NaN.
[[nodiscard]] Result<Image<float>> read_depth_npy(const std::filesystem::path& file);
/// An 8- or 16-bit PNG of one channel (or a colour one): 255 where it is not black, else 0.
[[nodiscard]] Result<Image<std::uint8_t>> read_mask(const std::filesystem::path& file);

/// PNG, or JPEG (quality 95) for the extensions jpg and jpeg.
[[nodiscard]] Result<void> write_color(const std::filesystem::path& file, const Image<Rgb8>& color);
/// 16-bit PNG: depth / metres_per_unit rounded to the nearest whole number, NaN as 0. Error for a depth that does not
/// fit (more than 65535 units, or positive but rounded to 0: it would become a hole).
[[nodiscard]] Result<void> write_depth(const std::filesystem::path& file, const Image<float>& depth_m,
                                       double metres_per_unit);
/// 8-bit PNG, 255 = set.
[[nodiscard]] Result<void> write_mask(const std::filesystem::path& file, const Image<std::uint8_t>& mask);

}  // namespace resight
