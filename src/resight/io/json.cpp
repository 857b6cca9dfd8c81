// SPDX-License-Identifier: Apache-2.0
#include "resight/io/internal/json.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "resight/core/json_text.hpp"
#include "resight/io/internal/text.hpp"
#include "resight/io/pose_text.hpp"

namespace resight::io {
namespace {

bool flatten(const nlohmann::json& json, std::vector<double>& numbers, int depth) {
  if (json.is_number()) {
    numbers.push_back(json.get<double>());
    return std::isfinite(numbers.back());
  }
  return json.is_array() && depth < 4 &&
         std::ranges::all_of(json, [&](const auto& item) { return flatten(item, numbers, depth + 1); });
}

}  // namespace

Result<nlohmann::json> read_json(const fs::path& file) {
  const auto text = read_file(file);
  if (!text) return text.error();
  auto json = parse_json(*text);
  if (!json) return file_error(file, json.error().message);
  return json;
}

Result<void> write_json(const fs::path& file, const nlohmann::json& json) {
  return write_file(file, to_json_text(json, kIndentedJson) + "\n");
}

const nlohmann::json& member(const nlohmann::json& json, std::string_view key) {
  static const nlohmann::json kNull;
  if (!json.is_object()) return kNull;
  const auto it = json.find(key);
  return it == json.end() ? kNull : *it;
}

std::optional<std::vector<double>> as_numbers(const nlohmann::json& json) {
  std::vector<double> numbers;
  if (!json.is_array() || !flatten(json, numbers, 0)) return std::nullopt;
  return numbers;
}

std::optional<double> as_number(const nlohmann::json& json) {
  return json.is_number() && std::isfinite(json.get<double>()) ? std::optional(json.get<double>()) : std::nullopt;
}

std::optional<int> as_integer(const nlohmann::json& json) {
  const auto number = as_number(json);
  if (!number || *number != std::floor(*number) || std::abs(*number) > INT32_MAX) return std::nullopt;
  return static_cast<int>(*number);
}

std::optional<std::string> as_text(const nlohmann::json& json) {
  return json.is_string() ? std::optional(json.get<std::string>()) : std::nullopt;
}

Result<Rigid3> rigid_from_bop(const nlohmann::json& rotation, const nlohmann::json& translation_mm,
                              std::string_view what) {
  const auto r = as_numbers(rotation);
  const auto t = as_numbers(translation_mm);
  if (!r || r->size() != 9 || !t || t->size() != 3)
    return Error{fmt::format("{}: expected 9 numbers of a rotation and 3 of a translation in mm", what)};
  Eigen::Matrix4d matrix = Eigen::Matrix4d::Identity();
  for (int row = 0; row < 3; ++row) {
    for (int col = 0; col < 3; ++col) matrix(row, col) = (*r)[3 * row + col];
    matrix(row, 3) = (*t)[row] * 1e-3;
  }
  return rigid_from_matrix(matrix, what);
}

nlohmann::json rotation_to_json(const Eigen::Matrix3d& rotation) {
  nlohmann::json json = nlohmann::json::array();
  for (int row = 0; row < 3; ++row)
    for (int col = 0; col < 3; ++col) json.push_back(rotation(row, col));
  return json;
}

nlohmann::json translation_to_json_mm(const Eigen::Vector3d& translation_m) {
  return {translation_m.x() * 1e3, translation_m.y() * 1e3, translation_m.z() * 1e3};
}

Result<std::vector<std::pair<int, const nlohmann::json*>>> numbered_members(const nlohmann::json& json,
                                                                            std::string_view what) {
  if (!json.is_object()) return Error{fmt::format("{}: expected a JSON object with a number for each key", what)};
  std::vector<std::pair<int, const nlohmann::json*>> members;
  for (const auto& [key, value] : json.items()) {
    const auto number = parse_integer(key);
    if (!number || *number < 0 || *number > INT32_MAX)
      return Error{fmt::format("{}: the key '{:.40}' is no number", what, key)};
    members.emplace_back(static_cast<int>(*number), &value);
  }
  using Member = std::pair<int, const nlohmann::json*>;
  std::ranges::sort(members, {}, &Member::first);
  if (const auto same = std::ranges::adjacent_find(members, {}, &Member::first); same != members.end())
    return Error{fmt::format("{}: several keys are the number {}", what, same->first)};
  return members;
}

}  // namespace resight::io
