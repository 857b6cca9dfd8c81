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

constexpr std::string_view kPngSignature = "\x89PNG\r\n\x1a\n";

/// A chunk of a PNG: length, type, data, checksum.
struct PngChunk {
  std::string_view all;
  std::string_view content;  ///< Type and data.
  /// The pixels need it: its type starts with a capital letter.
  [[nodiscard]] bool is_critical() const { return (content[0] & 0x20) == 0; }
  [[nodiscard]] bool is_intact() const { return compute_crc32(content) == big_endian(all, 4 + content.size(), 4); }
};

/// Cuts the next whole chunk off; none at the end.
std::optional<PngChunk> cut_png_chunk(std::string_view& rest) {
  constexpr std::size_t kFrame = 12;
  if (rest.size() < kFrame) return std::nullopt;
  const std::size_t length = big_endian(rest, 0, 4);
  if (length > rest.size() - kFrame) return std::nullopt;
  const PngChunk chunk{rest.substr(0, length + kFrame), rest.substr(4, length + 4)};
  rest.remove_prefix(chunk.all.size());
  return chunk;
}

std::optional<ImageHeader> parse_png(std::string_view bytes) {
  if (bytes.size() < kPngSignature.size() + 25 || bytes.substr(12, 4) != "IHDR") return std::nullopt;
  ImageHeader header;
  const std::uint32_t width = big_endian(bytes, 16, 4);
  const std::uint32_t height = big_endian(bytes, 20, 4);
  if (width > INT32_MAX || height > INT32_MAX) return std::nullopt;
  header.width = static_cast<int>(width);
  header.height = static_cast<int>(height);
  bytes.remove_prefix(kPngSignature.size());
  while (const auto chunk = cut_png_chunk(bytes)) {
    if (chunk->is_critical() && !chunk->is_intact()) header.intact = false;
    if (chunk->content.starts_with("IEND")) header.complete = true;
  }
  return header;
}

/// Whether a marker stands alone, without a segment.
bool stands_alone(unsigned char marker) { return marker <= 0x01 || (marker >= 0xD0 && marker <= 0xD8); }

bool is_start_of_frame(unsigned char marker) {
  return marker >= 0xC0 && marker <= 0xCF && marker != 0xC4 && marker != 0xC8 && marker != 0xCC;
}

/// Walks over the segments, and over the data of the scans between them, up to the end mark. The start of frame
/// contains the size.
std::optional<ImageHeader> parse_jpeg(std::string_view bytes) {
  constexpr unsigned char kEndOfImage = 0xD9;
  constexpr unsigned char kStartOfScan = 0xDA;
  std::optional<ImageHeader> header;
  std::size_t at = 2;
  while ((at = bytes.find('\xff', at)) != bytes.npos && at + 1 < bytes.size()) {
    const auto marker = static_cast<unsigned char>(bytes[at + 1]);
    if (marker == 0xFF) {
      ++at;  // fill bytes
      continue;
    }
    if (marker == kEndOfImage) {
      if (header) header->complete = true;
      break;
    }
    if (stands_alone(marker)) {
      at += 2;
      continue;
    }
    const bool tells_size = !header && is_start_of_frame(marker);
    if (bytes.size() - at < (tells_size ? 9 : 4)) break;
    if (tells_size)
      header = {.width = static_cast<int>(big_endian(bytes, at + 7, 2)),
                .height = static_cast<int>(big_endian(bytes, at + 5, 2))};
    if (header && marker == kStartOfScan) ++header->num_scans;
    at += 2 + big_endian(bytes, at + 2, 2);
  }
  return header;
}

}  // namespace

std::optional<ImageHeader> parse_image_header(std::string_view bytes) {
  if (bytes.starts_with(kPngSignature)) return parse_png(bytes);
  if (bytes.starts_with("\xff\xd8")) return parse_jpeg(bytes);
  return std::nullopt;
}

std::string keep_pixels(std::string_view bytes) {
  if (!bytes.starts_with(kPngSignature)) return std::string(bytes);
  std::string kept(kPngSignature);
  bytes.remove_prefix(kPngSignature.size());
  while (const auto chunk = cut_png_chunk(bytes))
    if (chunk->is_critical()) kept += chunk->all;
  return kept;
}

}  // namespace resight::io
