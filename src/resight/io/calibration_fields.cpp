// SPDX-License-Identifier: Apache-2.0
#include "resight/io/internal/calibration_fields.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <initializer_list>
#include <optional>
#include <utility>

#include "resight/io/internal/files.hpp"
#include "resight/io/internal/json.hpp"
#include "resight/io/internal/text.hpp"

namespace resight::io {
namespace {

using FieldNames = std::initializer_list<std::string_view>;

const std::vector<double>* find_numbers(const CalibrationFields& fields, FieldNames names) {
  for (const std::string_view name : names)
    if (const auto it = fields.numbers.find(std::string(name)); it != fields.numbers.end() && !it->second.empty())
      return &it->second;
  return nullptr;
}

std::optional<double> find_scalar(const CalibrationFields& fields, FieldNames names) {
  const std::vector<double>* numbers = find_numbers(fields, names);
  return numbers != nullptr && numbers->size() == 1 ? std::optional(numbers->front()) : std::nullopt;
}

std::optional<std::vector<double>> find_matrix(const CalibrationFields& fields) {
  const auto fx = find_scalar(fields, {"fx", "fl_x", "focal_x", "fx_color"});
  const auto fy = find_scalar(fields, {"fy", "fl_y", "focal_y", "fy_color"});
  const auto cx = find_scalar(fields, {"cx", "ppx", "c_x", "principal_x", "mx_color"});
  const auto cy = find_scalar(fields, {"cy", "ppy", "c_y", "principal_y", "my_color"});
  if (fx && fy && cx && cy) return std::vector<double>{*fx, *fy, *cx, *cy};
  const std::vector<double>* matrix = find_numbers(
      fields, {"camera_matrix", "intrinsic_matrix", "cam_k", "k", "intrinsics", "intrinsic", "color_intrinsic",
               "color_intrinsics", "camera_intrinsics", "camera_intrinsic", "m_calibrationcolorintrinsic", "matrix"});
  return matrix == nullptr ? std::nullopt : std::optional(*matrix);
}

/// The distortion model in the words of LensDistortion::make(); empty if the file leaves it open. Files call a fisheye
/// by several words under several names (nerfstudio: OPENCV_FISHEYE, ORB-SLAM3: KannalaBrandt8).
std::string find_lens_model(const CalibrationFields& fields) {
  if (const auto ros = fields.words.find("distortion_model"); ros != fields.words.end()) return ros->second;
  for (const char* name : {"camera_model", "lens_model", "model", "type"}) {
    const auto it = fields.words.find(name);
    if (it == fields.words.end()) continue;
    const std::string word = to_lower(it->second);
    for (const char* fisheye : {"fisheye", "equidistant", "kannala"})
      if (word.find(fisheye) != word.npos) return "equidistant";
  }
  return "";
}

std::vector<double> find_coefficients(const CalibrationFields& fields, std::string_view model) {
  if (const auto* list = find_numbers(
          fields, {"distortion_coefficients", "distortion_coeffs", "dist_coeffs", "distortion", "coeffs", "dist", "d"}))
    return *list;
  std::vector<double> coefficients;
  if (model == "equidistant") {
    for (const char* name : {"k1", "k2", "k3", "k4"}) coefficients.push_back(find_scalar(fields, {name}).value_or(0));
    return coefficients;
  }
  for (const char* name : {"k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6"})
    coefficients.push_back(find_scalar(fields, {name}).value_or(0));
  return coefficients;
}

/// Metres per unit. Files say metres per unit (RealSense: 0.001; Instant NGP: integer_depth_scale), millimetres (BOP:
/// 0.1 or 1), or units per metre.
std::optional<double> find_depth_unit(const CalibrationFields& fields) {
  if (const auto unit_m = find_scalar(fields, {"integer_depth_scale"}); unit_m && *unit_m > 0) return unit_m;
  const auto scale =
      find_scalar(fields, {"depth_scale", "depthscale", "depth_factor", "depthmapfactor", "png_depth_scale", "scale"});
  if (!scale || !(*scale > 0)) return std::nullopt;
  if (*scale >= 100) return 1 / *scale;
  return *scale > 0.0099 ? *scale * 1e-3 : *scale;
}

/// The part of a name behind the last dot or slash, in lower case: "Camera.fx" -> "fx".
std::string last_part(std::string_view name) {
  const std::size_t dot = name.find_last_of("./");
  return to_lower(dot == name.npos ? name : name.substr(dot + 1));
}

/// The part before, in lower case: "Camera.fx" -> "camera".
std::string group_of(std::string_view name) {
  const std::size_t dot = name.find_last_of("./");
  return dot == name.npos ? "" : to_lower(name.substr(0, dot));
}

bool is_separator(char c) {
  return c == ' ' || c == '\t' || c == '\r' || c == '\n' || c == ',' || c == ';' || c == '[' || c == ']' || c == '{' ||
         c == '}' || c == '(' || c == ')' || c == '"' || c == '\'';
}

/// The words of a line such as "fx 517.3", whose name has no colon.
std::optional<std::pair<std::string, std::string>> name_with_number(std::string_view line) {
  const auto words = split_tokens(line);
  const auto is_letter = [](char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; };
  if (words.size() != 2 || !std::ranges::all_of(words[0].substr(0, 1), is_letter) || !parse_number(words[1]) ||
      std::ranges::any_of(line,
                          [](char c) { return c == ':' || c == '=' || (is_separator(c) && c != ' ' && c != '\t'); }))
    return std::nullopt;
  return std::pair(std::string(words[0]), std::string(words[1]));
}

/// A line "- 525.0" of a list in YAML without its dash.
std::string_view without_dash(std::string_view line) {
  const std::size_t first = line.find_first_not_of(" \t");
  return first != line.npos && line.substr(first).starts_with("- ") ? line.substr(first + 2) : line;
}

/// The name in a line "[color]" of an ini file; empty for other lines.
std::string_view section_name(std::string_view line) {
  const auto words = split_tokens(line);
  if (words.size() != 1 || !words[0].starts_with('[') || !words[0].ends_with(']')) return "";
  const std::string_view name = words[0].substr(1, words[0].size() - 2);
  return parse_number(name) || name.find_first_of(",;:[") != name.npos ? "" : name;
}

/// Words of a text without comments. The end of a name becomes the word ":", and the names around it, by the
/// indentation of YAML or as the section of an ini file, become part of it: "color/fx".
std::vector<std::string> split_words(std::string_view text) {
  constexpr std::size_t kMaxGroupBytes = 200;
  std::vector<std::string> words(1);
  std::vector<std::pair<int, std::string>> around;  // Indentations and names.
  const auto end_word = [&] {
    if (!words.back().empty()) words.emplace_back();
  };
  while (!text.empty()) {
    std::string_view line = cut_line(text);
    line = line.substr(0, line.find('#'));
    auto indentation = static_cast<int>(std::min<std::size_t>(line.find_first_not_of(" \t-"), INT32_MAX));
    line = without_dash(line);
    if (const auto section = section_name(line); !section.empty())
      around = {{-1, std::string(section.substr(0, kMaxGroupBytes)) + '/'}};
    if (const auto pair = name_with_number(line)) {
      words.insert(words.end() - 1, {pair->first, ":", pair->second});
      continue;
    }
    for (const char c : line) {
      if (is_separator(c)) {
        end_word();
      } else if (c == ':' || c == '=') {
        end_word();
        if (words.size() > 1) {
          std::string& name = words[words.size() - 2];
          while (!around.empty() && around.back().first >= indentation) around.pop_back();
          const std::string before = around.empty() ? "" : around.back().second;
          // Not longer and longer ones: each name gets those around it.
          around.emplace_back(indentation, (before + name + '/').substr(0, kMaxGroupBytes));
          name.insert(0, before);
          indentation = INT32_MAX;  // Further names of the line are below the first.
        }
        words.back().assign(1, ':');
        end_word();
      } else {
        words.back() += c;
      }
    }
    end_word();
  }
  words.pop_back();
  return words;
}

CalibrationFields fields_of(const nlohmann::json& object) {
  CalibrationFields fields;
  for (const auto& [name, value] : object.items()) {
    const auto& list = member(value, "data").is_null() ? value : member(value, "data");
    if (const auto number = as_number(value)) fields.numbers[last_part(name)] = {*number};
    if (list.is_array())
      if (const auto numbers = as_numbers(list)) fields.numbers[last_part(name)] = *numbers;
    if (const auto word = as_text(value)) fields.words[last_part(name)] = *word;
  }
  // In the files of Instant NGP, "scale" is that of the scene.
  if (member(object, "frames").is_array()) fields.numbers.erase("scale");
  if (member(object, "is_fisheye") == true) fields.words["lens_model"] = "fisheye";
  return fields;
}

struct NamedCalibration {
  std::string where;
  Calibration calibration;
};

/// Of several cameras, that of the colours.
Result<Calibration> choose_camera(std::vector<NamedCalibration> found, std::string_view what) {
  const auto is_color = [](const NamedCalibration& c) {
    return c.where.find("color") != c.where.npos || c.where.find("rgb") != c.where.npos;
  };
  std::ranges::stable_sort(found, {}, [&](const NamedCalibration& c) { return is_color(c) ? 0 : 1; });
  Calibration chosen = found.front().calibration;
  for (const NamedCalibration& other : found)
    if (is_color(other) == is_color(found.front()) && !complete(chosen, other.calibration))
      return Error{
          fmt::format("{}: holds the intrinsics of several cameras ({}, {}); give one of them by "
                      "--intrinsics fx,fy,cx,cy",
                      what, found.front().where, other.where)};
  return chosen;
}

/// The content of a file with lines `name: value` or `name = value`.
struct GroupedFields {
  CalibrationFields all;
  std::map<std::string, CalibrationFields> groups;  ///< By the names around them.
};

GroupedFields parse_fields(std::string_view text) {
  const std::vector<std::string> words = split_words(text);
  GroupedFields fields;
  std::string group;  // the last name without a value
  for (std::size_t i = 0; i + 1 < words.size(); ++i) {
    if (words[i + 1] != ":" || words[i] == ":") continue;
    std::string name = last_part(words[i]);
    std::string where = group_of(words[i]);
    std::vector<double> numbers;
    std::size_t next = i + 2;
    if (next < words.size() && words[next] == "!!opencv-matrix") ++next;
    const bool is_group = next + 1 >= words.size() || words[next + 1] == ":";
    for (; next < words.size() && !(next + 1 < words.size() && words[next + 1] == ":"); ++next) {
      const auto number = parse_number(words[next]);
      if (!number) break;
      numbers.push_back(*number);
    }
    if (numbers.empty() && i + 2 < words.size() && !is_group)
      fields.all.words[name] = fields.groups[where].words[name] = words[i + 2];
    if (numbers.empty() && (is_group || (i + 2 < words.size() && words[i + 2] == "!!opencv-matrix"))) group = name;
    if (name == "data" && !group.empty()) {
      name = group;
      where = group_of(where);
    }
    if (numbers.empty()) continue;
    fields.groups[where].numbers.try_emplace(name, numbers);
    fields.all.numbers.try_emplace(name, std::move(numbers));
  }
  return fields;
}

Result<void> collect_json(const nlohmann::json& json, const std::string& where, int depth,
                          std::vector<NamedCalibration>& found, std::string_view file) {
  if (depth > 5 || found.size() > 100) return {};
  if (json.is_array() && !json.empty() && json.front().is_object())
    return collect_json(json.front(), where, depth + 1, found, file);
  if (!json.is_object()) return {};
  const auto calibration = calibration_from_json(json, file);
  if (!calibration) return calibration.error();
  if (*calibration) found.push_back({to_lower(where), **calibration});
  for (const auto& [name, value] : json.items())
    if (value.is_structured() && name != "frames")
      if (const auto done = collect_json(value, where + "/" + name, depth + 1, found, file); !done) return done;
  return {};
}

}  // namespace

std::optional<std::vector<double>> parse_number_list(std::string_view text) {
  std::vector<double> numbers;
  for (const std::string& word : split_words(text)) {
    const auto number = parse_number(word);
    if (!number || numbers.size() > 64) return std::nullopt;
    numbers.push_back(*number);
  }
  if (numbers.empty()) return std::nullopt;
  return numbers;
}

Result<std::optional<Calibration>> calibration_from_fields(const CalibrationFields& fields, std::string_view what) {
  const auto matrix = find_matrix(fields);
  if (!matrix || matrix->size() < 4) return std::optional<Calibration>();
  auto calibration = calibration_from_numbers(*matrix, what);
  if (!calibration) return calibration.error();
  const std::string model = find_lens_model(fields);
  const auto lens = LensDistortion::make(model, find_coefficients(fields, model));
  if (!lens) return Error{fmt::format("{}: {}", what, lens.error().message)};
  if (calibration->lens.is_none()) calibration->lens = *lens;
  const auto to_size = [](std::optional<double> size) {
    return size && *size > 0 && *size < 1e6 ? static_cast<int>(*size) : 0;
  };
  calibration->width = to_size(find_scalar(fields, {"width", "image_width", "w", "colorwidth"}));
  calibration->height = to_size(find_scalar(fields, {"height", "image_height", "h", "colorheight"}));
  calibration->metres_per_unit = find_depth_unit(fields);
  return std::optional(*calibration);
}

Result<std::optional<Calibration>> calibration_from_json(const nlohmann::json& object, std::string_view what) {
  if (!object.is_object()) return std::optional<Calibration>();
  return calibration_from_fields(fields_of(object), what);
}

Result<std::optional<Calibration>> calibration_from_text(std::string_view text, std::string_view what) {
  const GroupedFields fields = parse_fields(text);
  std::vector<NamedCalibration> found;
  for (const auto& [where, group] : fields.groups)
    if (const auto calibration = calibration_from_fields(group, what); calibration.ok() && *calibration)
      found.push_back({where, **calibration});
  if (found.size() < 2) return calibration_from_fields(fields.all, what);
  auto chosen = choose_camera(std::move(found), what);
  if (!chosen) return chosen.error();
  if (!chosen->metres_per_unit) chosen->metres_per_unit = find_depth_unit(fields.all);
  return std::optional(*chosen);
}

Result<Calibration> read_json_calibration(const fs::path& file) {
  const auto json = read_json(file);
  if (!json) return json.error();
  if (const auto numbers = as_numbers(*json)) return calibration_from_numbers(*numbers, file.string());
  std::vector<NamedCalibration> found;
  if (const auto done = collect_json(*json, "", 0, found, file.string()); !done) return done.error();
  if (found.empty()) return file_error(file, "holds no intrinsics (expected fx, fy, cx, cy or a camera matrix)");
  return choose_camera(std::move(found), file.string());
}

}  // namespace resight::io
