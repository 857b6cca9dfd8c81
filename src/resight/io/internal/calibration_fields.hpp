// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <map>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "resight/io/internal/calibration.hpp"

namespace resight::io {

/// The content of a settings file by name, in lower case. The numbers of a list `name: [..]`, also of several lines and
/// of the key "data" below its name, are the value of the name.
struct CalibrationFields {
  std::map<std::string, std::vector<double>> numbers;
  std::map<std::string, std::string> words;
};

/// Numbers separated by white space, commas, semicolons or brackets, without comments (#). None if anything else is in
/// the text.
[[nodiscard]] std::optional<std::vector<double>> parse_number_list(std::string_view text);

/// None if the fields hold no intrinsics.
[[nodiscard]] Result<std::optional<Calibration>> calibration_from_fields(const CalibrationFields& fields,
                                                                         std::string_view what);

/// The same for the members of a JSON object, without those inside others. None for other values.
[[nodiscard]] Result<std::optional<Calibration>> calibration_from_json(const nlohmann::json& object,
                                                                       std::string_view what);

/// The same for lines `name: value` or `name = value`. If several groups of them hold a camera, that of the colours.
[[nodiscard]] Result<std::optional<Calibration>> calibration_from_text(std::string_view text, std::string_view what);

/// The calibration anywhere in a JSON file; of several, that of the colour camera.
[[nodiscard]] Result<Calibration> read_json_calibration(const std::filesystem::path& file);

}  // namespace resight::io
