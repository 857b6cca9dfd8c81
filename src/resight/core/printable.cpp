// SPDX-License-Identifier: Apache-2.0
#include "resight/core/printable.hpp"

#include <cstddef>
#include <cstdint>

namespace resight {
namespace {

struct CodePoint {
  std::uint32_t value = 0;
  std::size_t num_bytes = 0;  ///< 0: not valid UTF-8.
};

CodePoint decode(std::string_view text) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  const unsigned char first = byte(0);
  if (first < 0x80) return {first, 1};
  const std::size_t length = first >= 0xF0 ? 4 : first >= 0xE0 ? 3 : 2;
  if (first < 0xC2 || first > 0xF4 || text.size() < length) return {};
  std::uint32_t value = first & (0xFFU >> (length + 1));
  for (std::size_t i = 1; i < length; ++i) {
    if ((byte(i) & 0xC0) != 0x80) return {};
    value = value << 6 | (byte(i) & 0x3FU);
  }
  constexpr std::uint32_t kLeast[] = {0, 0, 0x80, 0x800, 0x10000};  // smaller values have shorter encodings
  if (value < kLeast[length] || value > 0x10FFFF || (value >= 0xD800 && value <= 0xDFFF)) return {};
  return {value, length};
}

bool is_harmless(std::uint32_t c) {
  const bool control = c < 0x20 || (c >= 0x7F && c < 0xA0);
  const bool direction =
      c == 0x061C || c == 0x200E || c == 0x200F || (c >= 0x202A && c <= 0x202E) || (c >= 0x2066 && c <= 0x2069);
  const bool line_end = c == 0x2028 || c == 0x2029;
  return !control && !direction && !line_end;
}

void append_hexadecimal(std::string& text, std::uint32_t value, int num_digits) {
  for (int i = num_digits - 1; i >= 0; --i) text += "0123456789abcdef"[value >> (4 * i) & 15U];
}

void append_bytes(std::string& text, const CodePoint& /*c*/, std::string_view bytes) {
  for (const char byte : bytes) {
    text += "\\x";
    append_hexadecimal(text, static_cast<unsigned char>(byte), 2);
  }
}

/// All that is not harmless has four digits.
void append_json_escape(std::string& text, const CodePoint& c, std::string_view /*bytes*/) {
  constexpr std::uint32_t kReplacement = 0xFFFD;
  text += "\\u";
  append_hexadecimal(text, c.num_bytes > 0 ? c.value : kReplacement, 4);
}

template <typename AppendEscaped>
std::string escape_harmful(std::string_view text, const AppendEscaped& append_escaped) {
  std::string result;
  while (!text.empty()) {
    const CodePoint c = decode(text);
    const std::string_view bytes = text.substr(0, c.num_bytes == 0 ? 1 : c.num_bytes);
    if (c.num_bytes > 0 && is_harmless(c.value))
      result += bytes;
    else
      append_escaped(result, c, bytes);
    text.remove_prefix(bytes.size());
  }
  return result;
}

}  // namespace

std::string printable(std::string_view text) { return escape_harmful(text, append_bytes); }

std::string printable_json(std::string_view line) { return escape_harmful(line, append_json_escape); }

}  // namespace resight
