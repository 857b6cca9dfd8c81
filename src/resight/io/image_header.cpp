// SPDX-License-Identifier: Apache-2.0
#include "resight/io/internal/image_header.hpp"

#include <cstddef>
#include <cstdint>

#include "resight/core/crc32.hpp"

namespace resight::io {
namespace {

std::uint32_t big_endian(std::string_view bytes, std::size_t at, int count) {
  std::uint32_t value = 0;
  for (int i = 0; i < count; ++i) value = value << 8 | static_cast<unsigned char>(bytes[at + i]);
  return value;
}

/// Walks over the chunks: length, type, data, checksum. A chunk is critical if its type starts with a capital letter.
std::optional<ImageHeader> parse_png(std::string_view bytes) {
  constexpr std::size_t kSignature = 8;
  if (bytes.size() < kSignature + 25 || bytes.substr(12, 4) != "IHDR") return std::nullopt;
  ImageHeader header;
  const std::uint32_t width = big_endian(bytes, 16, 4);
  const std::uint32_t height = big_endian(bytes, 20, 4);
  if (width > INT32_MAX || height > INT32_MAX) return std::nullopt;
  header.width = static_cast<int>(width);
  header.height = static_cast<int>(height);
  std::size_t at = kSignature;
  while (bytes.size() - at >= 12) {
    const std::size_t length = big_endian(bytes, at, 4);
    if (length > bytes.size() - at - 12) break;
    const std::string_view content = bytes.substr(at + 4, length + 4);
    const bool matters = (content[0] & 0x20) == 0;
    if (matters && compute_crc32(content) != big_endian(bytes, at + 8 + length, 4)) header.intact = false;
    if (content.starts_with("IEND")) header.complete = true;
    at += length + 12;
  }
  return header;
}

/// Whether a marker stands alone, without a segment.
bool stands_alone(unsigned char marker) { return marker <= 0x01 || (marker >= 0xD0 && marker <= 0xD8); }

/// Walks over the segments up to the start of frame, which contains the size. In the data behind it, the end marker
/// cannot occur by chance.
std::optional<ImageHeader> parse_jpeg(std::string_view bytes) {
  std::size_t at = 2;
  while (at + 9 < bytes.size()) {
    const auto marker = static_cast<unsigned char>(bytes[at + 1]);
    if (bytes[at] != '\xff' || marker == 0xFF) {
      ++at;  // fill bytes
      continue;
    }
    const bool start_of_frame = marker >= 0xC0 && marker <= 0xCF && marker != 0xC4 && marker != 0xC8 && marker != 0xCC;
    if (start_of_frame) {
      ImageHeader header;
      header.height = static_cast<int>(big_endian(bytes, at + 5, 2));
      header.width = static_cast<int>(big_endian(bytes, at + 7, 2));
      header.complete = bytes.find("\xff\xd9", at) != bytes.npos;
      return header;
    }
    at += 2 + (stands_alone(marker) ? 0 : big_endian(bytes, at + 2, 2));
  }
  return std::nullopt;
}

}  // namespace

std::optional<ImageHeader> parse_image_header(std::string_view bytes) {
  if (bytes.starts_with("\x89PNG\r\n\x1a\n")) return parse_png(bytes);
  if (bytes.starts_with("\xff\xd8")) return parse_jpeg(bytes);
  return std::nullopt;
}

}  // namespace resight::io
