// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <string_view>

namespace resight::io {

/// Size and integrity of an encoded image.
struct ImageHeader {
  int width = 0;
  int height = 0;
  bool complete = false;  ///< The file contains its end mark, so it was not truncated.
  bool intact = true;     ///< PNG: the checksums of the critical chunks are correct.
};

/// Reads the size of a PNG or JPEG from its bytes before anything is decoded or allocated. None for other content.
[[nodiscard]] std::optional<ImageHeader> parse_image_header(std::string_view bytes);

}  // namespace resight::io
