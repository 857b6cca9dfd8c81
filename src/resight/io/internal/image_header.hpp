// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <string_view>

namespace resight::io {

struct ImageHeader {
  int width = 0;
  int height = 0;
  bool complete = false;  ///< The file has its end mark: it was not cut off.
  bool intact = true;     ///< PNG: the checksums of the chunks that matter are right.
};

/// Size of a PNG or JPEG, from its first bytes, before anything is decoded (or allocated). None for any other content.
[[nodiscard]] std::optional<ImageHeader> parse_image_header(std::string_view bytes);

}  // namespace resight::io
