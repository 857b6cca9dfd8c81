// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace resight::io {

/// Reads the tokens of a text, separated by white space, one by one without copies.
class TextCursor {
 public:
  explicit TextCursor(std::string_view text) : rest_(text) {}
  /// The next token; empty at the end.
  std::string_view next();
  /// The next token as a number; none at the end or if it is not a number.
  std::optional<double> next_number();
  [[nodiscard]] std::string_view rest() const { return rest_; }

 private:
  std::string_view rest_;
};

/// The whole token as a number ("nan" and "inf" included), independent of the locale.
[[nodiscard]] std::optional<double> parse_number(std::string_view token);
[[nodiscard]] std::optional<std::int64_t> parse_integer(std::string_view token);

/// All tokens of a text as numbers; none if one of them is not a number.
[[nodiscard]] std::optional<std::vector<double>> parse_numbers(std::string_view text);

/// Removes the next line from `text` and returns it without its end (LF or CR LF).
std::string_view cut_line(std::string_view& text);
[[nodiscard]] std::vector<std::string_view> split_tokens(std::string_view line);

/// Natural order of names, in which runs of digits count as numbers: view_9 < view_10, and view_01 < view_2.
[[nodiscard]] bool natural_less(std::string_view a, std::string_view b);

/// The digits at the end of a name as a number: "cloud_0012" -> 12. None without digits or with more than nine digits.
[[nodiscard]] std::optional<int> trailing_number(std::string_view name);

[[nodiscard]] std::string to_lower(std::string_view text);

/// Whether a name can be part of a file name on all systems: letters, digits and " _-.+", not starting with a dot.
[[nodiscard]] bool is_safe_name(std::string_view name);

}  // namespace resight::io
