// SPDX-License-Identifier: Apache-2.0
#include "resight/io/internal/image_header.hpp"

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>

namespace resight::io {
namespace {

std::uint32_t big_endian(std::string_view bytes, std::size_t at, int count) {
  std::uint32_t value = 0;
  for (int i = 0; i < count; ++i) value = value << 8 | static_cast<unsigned char>(bytes[at + i]);
  return value;
}

using CrcTables = std::array<std::array<std::uint32_t, 256>, 4>;

constexpr CrcTables make_crc_tables() {
  CrcTables tables{};
  for (std::uint32_t i = 0; i < 256; ++i) {
    std::uint32_t crc = i;
    for (int bit = 0; bit < 8; ++bit) crc = (crc & 1) != 0 ? 0xEDB88320U ^ crc >> 1 : crc >> 1;
    tables[0][i] = crc;
  }
  for (std::size_t t = 1; t < tables.size(); ++t)
    for (std::uint32_t i = 0; i < 256; ++i) tables[t][i] = tables[t - 1][i] >> 8 ^ tables[0][tables[t - 1][i] & 0xFF];
  return tables;
}

/// CRC-32 of PNG, four bytes per step.
std::uint32_t compute_crc(std::string_view bytes) {
  static constexpr CrcTables kTables = make_crc_tables();
  std::uint32_t crc = 0xFFFFFFFFU;
  std::size_t i = 0;
  for (; i + 4 <= bytes.size(); i += 4) {
    std::uint32_t word;
    std::memcpy(&word, bytes.data() + i, 4);  // little-endian
    crc ^= word;
    crc = kTables[3][crc & 0xFF] ^ kTables[2][crc >> 8 & 0xFF] ^ kTables[1][crc >> 16 & 0xFF] ^ kTables[0][crc >> 24];
  }
  for (; i < bytes.size(); ++i) crc = crc >> 8 ^ kTables[0][(crc ^ static_cast<unsigned char>(bytes[i])) & 0xFF];
  return ~crc;
}
static_assert(std::endian::native == std::endian::little);

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
    if (matters && compute_crc(content) != big_endian(bytes, at + 8 + length, 4)) header.intact = false;
    if (content.starts_with("IEND")) header.complete = true;
    at += length + 12;
  }
  return header;
}

/// Walks over the segments up to the start of frame, which contains the size.
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
      header.complete = bytes.substr(bytes.size() > 64 ? bytes.size() - 64 : 0).find("\xff\xd9") != bytes.npos;
      return header;
    }
    at += 2 + big_endian(bytes, at + 2, 2);
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
