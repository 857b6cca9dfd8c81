// SPDX-License-Identifier: Apache-2.0
#include "resight/io/internal/tuw_names.hpp"

#include "resight/io/internal/text.hpp"

namespace resight::io {
namespace {
bool is_decimal_digit(char c) { return c >= '0' && c <= '9'; }
}  // namespace

std::string normalized_view(std::string_view name) {
  std::string normalized;
  for (std::size_t i = 0; i < name.size(); ++i) {
    const bool leading_zero = name[i] == '0' && (i == 0 || !is_decimal_digit(name[i - 1])) && i + 1 < name.size() &&
                              is_decimal_digit(name[i + 1]);
    // In a run of zeros, all but the last are leading zeros, since the zero before them was dropped.
    if (leading_zero) {
      while (i + 1 < name.size() && name[i] == '0' && is_decimal_digit(name[i + 1])) ++i;
    }
    normalized += name[i];
  }
  return normalized;
}

std::optional<ObjectInstance> split_object_instance(std::string_view text) {
  const std::size_t underscore = text.rfind('_');
  if (underscore == text.npos || underscore == 0) return std::nullopt;
  const auto number = parse_integer(text.substr(underscore + 1));
  if (!number || *number < 0 || *number > INT32_MAX) return std::nullopt;
  return ObjectInstance{std::string(text.substr(0, underscore)), static_cast<int>(*number)};
}

std::optional<AnnotationName> split_annotation_name(std::string_view stem) {
  std::size_t begin = 0;
  while (begin < stem.size() && !is_decimal_digit(stem[begin])) ++begin;
  std::size_t end = begin;
  while (end < stem.size() && is_decimal_digit(stem[end])) ++end;
  if (begin == end || end >= stem.size() || stem[end] != '_') return std::nullopt;
  const auto number = trailing_number(stem.substr(0, end));
  auto what = split_object_instance(stem.substr(end + 1));
  if (!number || !what) return std::nullopt;
  return AnnotationName{std::string(stem.substr(0, end)), *number, std::move(*what)};
}

}  // namespace resight::io
