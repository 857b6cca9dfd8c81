// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <span>
#include <string_view>

namespace resight {

/// A file of the page that the viewer shows; it is part of the program.
struct Asset {
  std::string_view path;
  std::string_view content_type;
  std::string_view bytes;
};

/// The files of web/dist.
[[nodiscard]] std::span<const Asset> viewer_assets();

}  // namespace resight
