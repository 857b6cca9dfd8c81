// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <nlohmann/json.hpp>
#include <optional>
#include <string_view>
#include <vector>

#include "resight/geometry/rigid3.hpp"
#include "resight/io/internal/files.hpp"
#include "resight/io/parse_json.hpp"

namespace resight::io {

/// parse_json() for a file, which the error names.
[[nodiscard]] Result<nlohmann::json> read_json(const fs::path& file);
[[nodiscard]] Result<void> write_json(const fs::path& file, const nlohmann::json& json);

/// json[key], or null if json is not an object or has no such key.
[[nodiscard]] const nlohmann::json& member(const nlohmann::json& json, std::string_view key);
/// An array of finite numbers, with nested arrays flattened; none for other values.
[[nodiscard]] std::optional<std::vector<double>> as_numbers(const nlohmann::json& json);
/// A finite number, a whole number that fits into an int, or a text; none for other values.
[[nodiscard]] std::optional<double> as_number(const nlohmann::json& json);
[[nodiscard]] std::optional<int> as_integer(const nlohmann::json& json);
[[nodiscard]] std::optional<std::string> as_text(const nlohmann::json& json);

/// Parses a rotation (9 numbers) and a translation in mm (3 numbers), as in BOP. `what` starts the error message.
[[nodiscard]] Result<Rigid3> rigid_from_bop(const nlohmann::json& rotation, const nlohmann::json& translation_mm,
                                            std::string_view what);
/// Converts to the numbers that rigid_from_bop() parses.
[[nodiscard]] nlohmann::json rotation_to_json(const Eigen::Matrix3d& rotation);
[[nodiscard]] nlohmann::json translation_to_json_mm(const Eigen::Vector3d& translation_m);

/// Entries of {"0": .., "12": ..} in numerical order. Fails if json is not an object or a key is not a whole number.
[[nodiscard]] Result<std::vector<std::pair<int, const nlohmann::json*>>> numbered_members(const nlohmann::json& json,
                                                                                          std::string_view what);

}  // namespace resight::io
