// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <string>
#include <string_view>

namespace resight::io {

/// Size and integrity of an encoded image.
struct ImageHeader {
  int width = 0;
  int height = 0;
  bool complete = false;  ///< The file contains its end mark, so it was not truncated.
  bool intact = true;     ///< PNG: the checksums of the critical chunks are correct.
  int num_scans = 0;      ///< JPEG: each one costs the time of the whole image.
};

/// Reads the size of a PNG or JPEG from its bytes before anything is decoded or allocated. None for other content.
[[nodiscard]] std::optional<ImageHeader> parse_image_header(std::string_view bytes);

/// The image without what its pixels do not need: libpng prints names from the other chunks of a PNG.
[[nodiscard]] std::string keep_pixels(std::string_view bytes);

}  // namespace resight::io
