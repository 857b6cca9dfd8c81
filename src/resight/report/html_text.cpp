// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <cmath>

#include "resight/report/internal/html.hpp"

namespace resight::report {

std::string escape(std::string_view text) {
  std::string safe;
  safe.reserve(text.size());
  for (const char c : text) {
    switch (c) {
      case '&':
        safe += "&amp;";
        break;
      case '<':
        safe += "&lt;";
        break;
      case '>':
        safe += "&gt;";
        break;
      case '"':
        safe += "&quot;";
        break;
      case '\'':
        safe += "&#39;";
        break;
      default:
        safe += c;
    }
  }
  return safe;
}

std::string base64(std::span<const std::uint8_t> bytes) {
  static constexpr char kDigits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t left = bytes.size() - i;
    const unsigned group = static_cast<unsigned>(bytes[i]) << 16 |
                           (left > 1 ? static_cast<unsigned>(bytes[i + 1]) << 8 : 0U) |
                           (left > 2 ? static_cast<unsigned>(bytes[i + 2]) : 0U);
    text += kDigits[group >> 18 & 63U];
    text += kDigits[group >> 12 & 63U];
    text += left > 1 ? kDigits[group >> 6 & 63U] : '=';
    text += left > 2 ? kDigits[group & 63U] : '=';
  }
  return text;
}

std::string number(double value, int digits) {
  return std::isnan(value) ? std::string("–") : fmt::format("{:.{}f}", value, digits);
}

std::string percent(double share) {
  return std::isnan(share) ? std::string("–") : fmt::format("{:.0f} %", 100 * share);
}

std::string duration(double seconds) {
  if (std::isnan(seconds)) return "–";
  return seconds < 1.0 ? fmt::format("{:.{}f} ms", 1000 * seconds, seconds < 0.00995 ? 1 : 0)
                       : fmt::format("{:.2f} s", seconds);
}

std::string css_color(Rgb8 color) { return fmt::format("#{:02x}{:02x}{:02x}", color.r, color.g, color.b); }

std::string object_name(int object, const ModelLibrary& library) { return escape(library.object(object).name); }

std::string object_tag(int object, const ModelLibrary& library) {
  return fmt::format("<span class=\"patch\" style=\"background:{}\"></span>{}", css_color(object_color(object)),
                     object_name(object, library));
}

}  // namespace resight::report
