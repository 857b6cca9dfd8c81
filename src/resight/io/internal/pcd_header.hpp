// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "resight/core/result.hpp"
#include "resight/io/pcd.hpp"

namespace resight::io {

/// One field of a PCD: `count` values of `size` bytes and type 'F', 'I' or 'U'.
struct PcdField {
  std::string name;
  int size = 4;
  char type = 'F';
  int count = 1;
  std::size_t offset = 0;  ///< Bytes from the start of a point.
  std::size_t column = 0;  ///< Values from the start of a point (ascii).
  [[nodiscard]] std::size_t bytes() const { return static_cast<std::size_t>(size) * static_cast<std::size_t>(count); }
};

/// A parsed PCD header. Offsets are in bytes.
struct PcdHeader {
  std::vector<PcdField> fields;
  int width = 0;
  int height = 0;
  Rigid3 viewpoint;
  std::optional<Camera> camera;  ///< The image size is that of the cloud if the file does not state it.
  PcdEncoding encoding = PcdEncoding::kAscii;
  std::size_t body_offset = 0;
  std::size_t point_bytes = 0;
  std::size_t values_per_point = 0;

  [[nodiscard]] std::size_t num_points() const {
    return static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  }
  [[nodiscard]] const PcdField* find(std::string_view name) const;
};

/// Parses the header. `bytes` may end anywhere after it.
[[nodiscard]] Result<PcdHeader> parse_pcd_header(std::string_view bytes, std::string_view name);
/// Reads only the header of a file.
[[nodiscard]] Result<PcdHeader> read_pcd_header(const std::filesystem::path& file);

}  // namespace resight::io
