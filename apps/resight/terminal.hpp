// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <fmt/format.h>

#include <concepts>
#include <string_view>
#include <utility>

#include "resight/core/printable.hpp"

namespace resight::app {

/// Names and paths come from files of others. Everything that the program prints goes through this file, which makes
/// it printable, so that no name controls the terminal or forges a line.

/// Prints to standard output. Line ends in `text` stay.
void print_text(std::string_view text);
/// Prints JSON to standard output, which remains JSON.
void print_json(std::string_view json);
/// Writes out what was printed. False if not all of it could be written.
[[nodiscard]] bool finish_output();

/// Prints "resight: <kind><what>" as one line to standard error.
void print_error_line(std::string_view kind, std::string_view what);

template <typename T>
auto printable_argument(const T& value) {
  if constexpr (std::convertible_to<const T&, std::string_view>)
    return printable(value);
  else
    return value;
}

/// Formats and prints to standard output. Line ends stay in the format, but not in its arguments.
template <typename... Args>
void print(fmt::format_string<decltype(printable_argument(std::declval<const Args&>()))...> format,
           const Args&... args) {
  print_text(fmt::format(format, printable_argument(args)...));
}

}  // namespace resight::app
