// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include "resight/core/names.hpp"
#include "resight/geometry/limits.hpp"
#include "resight/io/internal/bop_dataset.hpp"
#include "resight/io/internal/json.hpp"
#include "resight/io/internal/model_info.hpp"
#include "resight/io/internal/text.hpp"
#include "resight/io/pose_text.hpp"

namespace resight::io {
namespace {

Result<Rigid3> parse_discrete(const nlohmann::json& json, std::string_view what) {
  const auto numbers = as_numbers(json);
  if (!numbers || numbers->size() != 16)
    return Error{fmt::format("{}: symmetries_discrete must be 4x4 matrices of 16 numbers", what)};
  Eigen::Matrix4d matrix;
  for (int i = 0; i < 16; ++i) matrix(i / 4, i % 4) = (*numbers)[i];
  matrix.topRightCorner<3, 1>() *= 1e-3;
  auto motion = rigid_from_matrix(matrix, fmt::format("{}: symmetries_discrete", what));
  if (motion.ok() && !is_possible_symmetry(*motion))
    return Error{fmt::format("{}: symmetries_discrete: a translation is {:.4g} m long (at most {} m along each axis)",
                             what, motion->translation.stableNorm(), 2 * kMaxObjectCoordinate_m)};
  return motion;
}

Result<RotationAxis> parse_continuous(const nlohmann::json& json, std::string_view what) {
  const auto direction = as_numbers(member(json, "axis"));
  const auto offset = as_numbers(member(json, "offset"));
  const bool sized = direction && direction->size() == 3 && (!offset || offset->size() == 3);
  RotationAxis axis;
  if (sized) axis.direction = {(*direction)[0], (*direction)[1], (*direction)[2]};
  if (!sized || !(axis.direction.stableNorm() > 1e-6))
    return Error{fmt::format("{}: symmetries_continuous need an axis and an offset of 3 numbers", what)};
  axis.direction.stableNormalize();
  if (offset) axis.point = Eigen::Vector3d((*offset)[0], (*offset)[1], (*offset)[2]) * 1e-3;
  if (!is_possible_symmetry(axis))
    return Error{fmt::format("{}: symmetries_continuous: an offset is {:.4g} m long (at most {} m along each axis)",
                             what, axis.point.stableNorm(), kMaxObjectCoordinate_m)};
  return axis;
}

}  // namespace

Result<ObjectSymmetries> parse_symmetries(const nlohmann::json& json, std::string_view what) {
  ObjectSymmetries symmetries;
  const nlohmann::json& discrete = member(json, "symmetries_discrete");
  const nlohmann::json& continuous = member(json, "symmetries_continuous");
  if ((!discrete.is_null() && !discrete.is_array()) || (!continuous.is_null() && !continuous.is_array()))
    return Error{fmt::format("{}: the symmetries must be lists", what)};
  for (const auto& item : discrete) {
    const auto symmetry = parse_discrete(item, what);
    if (!symmetry) return symmetry.error();
    symmetries.discrete.push_back(*symmetry);
  }
  for (const auto& item : continuous) {
    const auto symmetry = parse_continuous(item, what);
    if (!symmetry) return symmetry.error();
    symmetries.continuous.push_back(*symmetry);
  }
  if (!has_few_motions(symmetries))
    return Error{fmt::format("{}: more than {} symmetry motions, in steps of 5 deg", what, kMaxSymmetryMotions)};
  return symmetries;
}

void add_symmetries(nlohmann::json& json, const ObjectSymmetries& symmetries) {
  for (const Rigid3& symmetry : symmetries.discrete) {
    Eigen::Matrix4d m = symmetry.matrix();
    m.topRightCorner<3, 1>() *= 1e3;
    nlohmann::json numbers = nlohmann::json::array();
    for (int i = 0; i < 16; ++i) numbers.push_back(m(i / 4, i % 4));
    json["symmetries_discrete"].push_back(std::move(numbers));
  }
  for (const auto& [direction, point] : symmetries.continuous)
    json["symmetries_continuous"].push_back(
        {{"axis", {direction.x(), direction.y(), direction.z()}}, {"offset", translation_to_json_mm(point)}});
}

std::string bop_object_name(int bop_id) { return fmt::format("obj_{:06}", bop_id); }
std::string bop_number(int number) { return fmt::format("{:06}", number); }

std::optional<int> parse_bop_object_name(std::string_view stem) {
  if (!stem.starts_with("obj_")) return std::nullopt;
  const auto number = parse_integer(stem.substr(4));
  return number && *number >= 0 && *number <= INT32_MAX ? std::optional(static_cast<int>(*number)) : std::nullopt;
}

Result<std::map<int, BopModelInfo>> read_models_info(const fs::path& file) {
  const auto json = read_json(file);
  if (!json) return json.error();
  const auto members = numbered_members(*json, file.string());
  if (!members) return members.error();
  std::map<int, BopModelInfo> infos;
  for (const auto& [id, entry] : *members) {
    auto symmetries = parse_symmetries(*entry, fmt::format("{}: object {}", file.string(), id));
    if (!symmetries) return symmetries.error();
    std::string name = as_text(member(*entry, "name")).value_or(bop_object_name(id));
    if (const auto checked = check_object_name(name); !checked)
      return file_error(file, fmt::format("object {}: {}", id, checked.error().message));
    infos[id] = {std::move(name), std::move(*symmetries)};
  }
  return infos;
}

std::optional<fs::path> find_models_info(const fs::path& directory) {
  fs::path base = fs::absolute(directory).lexically_normal();
  if (!base.has_filename()) base = base.parent_path();
  for (int level = 0; level < 4 && !base.empty(); ++level, base = base.parent_path()) {
    for (const char* folder : {"models", "models_eval", "models_cad", "models_fine"})
      if (is_there(base / folder / "models_info.json")) return base / folder / "models_info.json";
  }
  return std::nullopt;
}

}  // namespace resight::io
