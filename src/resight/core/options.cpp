// SPDX-License-Identifier: Apache-2.0
#include "resight/core/options.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numeric>
#include <stdexcept>

#include "resight/core/check.hpp"

namespace resight {
namespace {

// The shortest text that reads back as the same number: 0.15, 1e-05, 5.
std::string shortest_text(double value) { return fmt::format("{}", value); }

std::string rounded_text(double value) { return fmt::format("{:g}", value); }

struct ToText {
  std::string operator()(const bool* v) const { return *v ? "true" : "false"; }
  std::string operator()(const int* v) const { return std::to_string(*v); }
  std::string operator()(const std::uint64_t* v) const { return std::to_string(*v); }
  std::string operator()(const double* v) const { return shortest_text(*v); }
  std::string operator()(const std::optional<int>* v) const { return *v ? std::to_string(**v) : "off"; }
  std::string operator()(const std::optional<double>* v) const { return *v ? shortest_text(**v) : "off"; }
  std::string operator()(const OptionChoice& choice) const {
    return std::string(choice.alternatives[static_cast<std::size_t>(choice.index(choice.value))].name);
  }
};

std::optional<double> number_in(const OptionValue& value) {
  const auto* number = std::get_if<double>(&value);
  if (number != nullptr && std::isfinite(*number)) return *number;
  if (const auto* whole = std::get_if<std::int64_t>(&value)) return static_cast<double>(*whole);
  return std::nullopt;
}

std::optional<int> whole_number_in(const OptionValue& value) {
  constexpr std::int64_t kLimit = 1000000000;
  const auto* whole = std::get_if<std::int64_t>(&value);
  if (whole == nullptr || *whole < -kLimit || *whole > kLimit) return std::nullopt;
  return static_cast<int>(*whole);
}

bool is_off(const OptionValue& value) {
  const auto* word = std::get_if<std::string>(&value);
  return word != nullptr && *word == "off";
}

// Takes a value over; returns what was expected if it does not fit.
struct Assign {
  const OptionValue& value;

  std::string operator()(bool* v) const {
    const bool* given = std::get_if<bool>(&value);
    if (given == nullptr) return "true or false";
    *v = *given;
    return {};
  }
  std::string operator()(int* v) const {
    const std::optional<int> given = whole_number_in(value);
    if (!given) return "a whole number";
    *v = *given;
    return {};
  }
  std::string operator()(std::optional<int>* v) const {
    const std::optional<int> given = whole_number_in(value);
    if (!given && !is_off(value)) return "a whole number or \"off\"";
    *v = given;
    return {};
  }
  std::string operator()(std::uint64_t* v) const {
    const std::int64_t* given = std::get_if<std::int64_t>(&value);
    if (given == nullptr || *given < 0) return "a whole number >= 0";
    *v = static_cast<std::uint64_t>(*given);
    return {};
  }
  std::string operator()(double* v) const {
    const std::optional<double> given = number_in(value);
    if (!given) return "a number";
    *v = *given;
    return {};
  }
  std::string operator()(std::optional<double>* v) const {
    const std::optional<double> given = number_in(value);
    if (!given && !is_off(value)) return "a number or \"off\"";
    *v = given;
    return {};
  }
  std::string operator()(const OptionChoice& choice) const {
    std::string_view name;
    if (const bool* flag = std::get_if<bool>(&value)) name = *flag ? "true" : "false";
    if (const std::string* word = std::get_if<std::string>(&value)) name = *word;
    std::string expected = "one of";
    for (std::size_t i = 0; i < choice.alternatives.size(); ++i) {
      if (choice.alternatives[i].name == name) {
        choice.select(choice.value, static_cast<int>(i));
        return {};
      }
      expected += (i > 0 ? ", \"" : " \"") + std::string(choice.alternatives[i].name) + "\"";
    }
    const bool is_switch = choice.alternatives[0].name == "false";
    return is_switch ? "true or false" : expected;
  }
};

// Levenshtein's distance if it is below `limit`, otherwise `limit` or more.
int edit_distance(std::string_view a, std::string_view b, int limit) {
  if (std::abs(static_cast<int>(a.size()) - static_cast<int>(b.size())) >= limit) return limit;
  std::vector<int> row(b.size() + 1);
  std::iota(row.begin(), row.end(), 0);
  for (std::size_t i = 0; i < a.size(); ++i) {
    int diagonal = row[0];
    row[0] = static_cast<int>(i) + 1;
    for (std::size_t k = 0; k < b.size(); ++k) {
      const int changed = diagonal + (a[i] == b[k] ? 0 : 1);
      diagonal = row[k + 1];
      row[k + 1] = std::min({changed, row[k] + 1, row[k + 1] + 1});
    }
    if (*std::ranges::min_element(row) >= limit) return limit;
  }
  return row[b.size()];
}

std::string_view last_part(std::string_view key) {
  const std::size_t dot = key.rfind('.');
  return dot == std::string_view::npos ? key : key.substr(dot + 1);
}

}  // namespace

std::string OptionRange::rule() const {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  if (max == kInfinity) {
    if (min == -kInfinity) return "a number";
    return (excludes_min ? "> " : ">= ") + rounded_text(min);
  }
  return std::string("in ") + (excludes_min ? "(" : "[") + rounded_text(min) + ", " + rounded_text(max) + "]";
}

std::string OptionVisitor::key_of(std::string_view name) const {
  std::string key;
  for (const std::string_view part : path_) key.append(part).append(".");
  return key.append(name);
}

std::string OptionVisitor::unmet_condition() const {
  if (conditions_.empty()) return {};
  const Condition& condition = conditions_.front();
  std::string text;
  for (std::size_t i = 0; i < condition.depth; ++i) text.append(path_[i]).append(".");
  return text.append(condition.key).append(" = ").append(condition.value);
}

std::string option_text(const OptionPointer& pointer) { return std::visit(ToText{}, pointer); }

std::string assign_option(const Option& option, const OptionValue& value) {
  OptionPointer pointer = option.pointer;
  if (auto* choice = std::get_if<OptionChoice>(&pointer)) choice->alternatives = option.alternatives;
  return std::visit(Assign{value}, pointer);
}

std::string joined_values(std::span<const Option> options) {
  std::string text;
  for (const Option& option : options) {
    if (!text.empty()) text += ' ';
    text += option.value == "off" ? "0" : option.value;
  }
  return text;
}

std::vector<std::pair<std::string, std::string>> settings_of(std::span<const Option> options) {
  std::vector<std::pair<std::string, std::string>> settings;
  for (const Option& option : options)
    if (option.condition.empty()) settings.emplace_back(option.key, option.value);
  return settings;
}

std::string nearest_key(std::span<const Option> options, std::string_view unknown) {
  // The same last part in another section is nearer than any other spelling, and so is one that contains the other.
  constexpr int kNameWeight = 10;
  const std::string_view name = last_part(unknown);
  std::string nearest;
  int best = std::numeric_limits<int>::max();
  for (const Option& option : options) {
    const std::string_view known = last_part(option.key);
    const bool contained = known.find(name) != std::string_view::npos || name.find(known) != std::string_view::npos;
    const int of_names = contained ? (known == name ? 0 : 1) : edit_distance(known, name, best / kNameWeight + 1);
    const int distance = kNameWeight * of_names + edit_distance(option.key, unknown, best - kNameWeight * of_names);
    if (distance >= best) continue;
    best = distance;
    nearest = option.key;
  }
  return nearest;
}

namespace internal {

void ListVisitor::visit(const OptionDeclaration& declared) {
  Option option{.key = key_of(declared.name),
                .doc = declared.doc,
                .source = declared.source,
                .range = declared.range,
                .pointer = declared.pointer,
                .alternatives = {},
                .value = option_text(declared.pointer),
                .condition = unmet_condition()};
  if (auto* choice = std::get_if<OptionChoice>(&option.pointer)) {
    option.alternatives.assign(choice->alternatives.begin(), choice->alternatives.end());
    choice->alternatives = {};  // Those of the declaration do not outlive it.
  }
  options.push_back(std::move(option));
}

std::string CheckVisitor::full_name(std::string_view option) const {
  return name_.empty() ? key_of(option) : std::string(name_) + "." + key_of(option);
}

void CheckVisitor::visit(const OptionDeclaration& option) {
  std::optional<double> value;
  if (auto* const* number = std::get_if<double*>(&option.pointer)) value = **number;
  if (auto* const* number = std::get_if<int*>(&option.pointer)) value = **number;
  if (auto* const* number = std::get_if<std::optional<int>*>(&option.pointer)) value = **number;
  if (auto* const* number = std::get_if<std::optional<double>*>(&option.pointer)) value = **number;
  if (!value || option.range.contains(*value)) return;
  throw std::invalid_argument(full_name(option.name) + " = " + rounded_text(*value) + " (must be " +
                              option.range.rule() + ")");
}

void CheckVisitor::visit_num_threads(int& num_threads) {
  require(num_threads >= 1, full_name("num_threads") + " = " + std::to_string(num_threads) + " (must be >= 1)");
}

void CheckVisitor::broken_rule(std::string_view message) {
  std::string name = full_name("");
  if (!name.empty()) name.back() = ':';  // A dot.
  throw std::invalid_argument(name + (name.empty() ? "" : " ") + std::string(message));
}

}  // namespace internal
}  // namespace resight
