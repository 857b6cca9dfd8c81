// SPDX-License-Identifier: Apache-2.0
#include "resight/io/internal/text.hpp"

#include <algorithm>
#include <charconv>

namespace resight::io {
namespace {

bool is_space(char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r' || c == '\v' || c == '\f'; }
bool is_digit(char c) { return c >= '0' && c <= '9'; }

/// Removes a leading plus sign, which C and Fortran programs write and std::from_chars rejects.
std::string_view without_plus(std::string_view token) {
  if (token.size() > 1 && token[0] == '+' && token[1] != '-' && token[1] != '+') token.remove_prefix(1);
  return token;
}

/// Removes the leading run of digits from `text` and returns it without leading zeros.
std::string_view cut_digits(std::string_view& text) {
  std::size_t end = 0;
  while (end < text.size() && is_digit(text[end])) ++end;
  std::string_view digits = text.substr(0, end);
  text.remove_prefix(end);
  while (digits.size() > 1 && digits[0] == '0') digits.remove_prefix(1);
  return digits;
}

}  // namespace

std::string_view TextCursor::next() {
  std::size_t begin = 0;
  while (begin < rest_.size() && is_space(rest_[begin])) ++begin;
  std::size_t end = begin;
  while (end < rest_.size() && !is_space(rest_[end])) ++end;
  const std::string_view token = rest_.substr(begin, end - begin);
  rest_.remove_prefix(end);
  return token;
}

std::optional<double> TextCursor::next_number() { return parse_number(next()); }

std::optional<double> parse_number(std::string_view token) {
  token = without_plus(token);
  if (token.empty()) return std::nullopt;
  double value = 0;
  const char* end = token.data() + token.size();
  const auto [stop, error] = std::from_chars(token.data(), end, value);
  if (stop != end) return std::nullopt;
  // A number too small for a double becomes zero. A number too large is not valid in any format.
  if (error == std::errc::result_out_of_range)
    return token.find("e-") != token.npos || token.find("E-") != token.npos ? std::optional<double>(0.0) : std::nullopt;
  if (error != std::errc()) return std::nullopt;
  return value;
}

std::optional<std::int64_t> parse_integer(std::string_view token) {
  token = without_plus(token);
  std::int64_t value = 0;
  const char* end = token.data() + token.size();
  const auto [stop, error] = std::from_chars(token.data(), end, value);
  if (token.empty() || stop != end || error != std::errc()) return std::nullopt;
  return value;
}

std::optional<std::vector<double>> parse_numbers(std::string_view text) {
  std::vector<double> numbers;
  TextCursor cursor(text);
  for (std::string_view token = cursor.next(); !token.empty(); token = cursor.next()) {
    const auto number = parse_number(token);
    if (!number) return std::nullopt;
    numbers.push_back(*number);
  }
  return numbers;
}

std::string_view cut_line(std::string_view& text) {
  const std::size_t end = text.find('\n');
  std::string_view line = text.substr(0, end);
  text.remove_prefix(end == text.npos ? text.size() : end + 1);
  if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
  return line;
}

std::vector<std::string_view> split_tokens(std::string_view line) {
  std::vector<std::string_view> tokens;
  TextCursor cursor(line);
  for (std::string_view token = cursor.next(); !token.empty(); token = cursor.next()) tokens.push_back(token);
  return tokens;
}

bool natural_less(std::string_view a, std::string_view b) {
  const std::string_view whole_a = a;
  const std::string_view whole_b = b;
  while (!a.empty() && !b.empty()) {
    if (is_digit(a[0]) && is_digit(b[0])) {
      const std::string_view x = cut_digits(a);
      const std::string_view y = cut_digits(b);
      if (x.size() != y.size()) return x.size() < y.size();
      if (x != y) return x < y;
    } else {
      if (a[0] != b[0]) return a[0] < b[0];
      a.remove_prefix(1);
      b.remove_prefix(1);
    }
  }
  if (a.empty() != b.empty()) return a.empty();
  return whole_a < whole_b;  // "1" and "01" are different names; any fixed order is sufficient
}

std::optional<int> trailing_number(std::string_view name) {
  std::size_t begin = name.size();
  while (begin > 0 && is_digit(name[begin - 1])) --begin;
  std::string_view rest = name.substr(begin);
  if (rest.empty()) return std::nullopt;
  const std::string_view digits = cut_digits(rest);
  if (digits.size() > 9) return std::nullopt;
  return static_cast<int>(*parse_integer(digits));
}

std::string to_lower(std::string_view text) {
  std::string lower(text);
  std::ranges::transform(lower, lower.begin(),
                         [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; });
  return lower;
}

bool is_safe_name(std::string_view name) {
  if (name.empty() || name.size() > 200 || name[0] == '.' || name[0] == ' ') return false;
  return std::ranges::all_of(name, [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || is_digit(c) || c == '_' || c == '-' || c == '.' ||
           c == '+' || c == ' ';
  });
}

}  // namespace resight::io
