// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <map>
#include <optional>
#include <string>

#include "resight/core/result.hpp"
#include "resight/geometry/symmetry.hpp"
#include "resight/io/internal/listed_sequence.hpp"

namespace resight::io {

/// An entry of models_info.json.
struct BopModelInfo {
  std::string name;  ///< Our optional key "name"; default obj_000005.
  ObjectSymmetries symmetries;
};

/// "obj_000005".
[[nodiscard]] std::string bop_object_name(int bop_id);
/// "000012".
[[nodiscard]] std::string bop_number(int number);
/// The number of "obj_000005.ply" or its stem; none for other names.
[[nodiscard]] std::optional<int> parse_bop_object_name(std::string_view stem);

/// Reads models_info.json, indexed by obj_id.
[[nodiscard]] Result<std::map<int, BopModelInfo>> read_models_info(const std::filesystem::path& file);

/// Finds the models_info.json of the data set that contains `directory` (a scene, a split, or the data set itself).
/// Searches models, models_eval and other models_* folders up to three levels up.
[[nodiscard]] std::optional<std::filesystem::path> find_models_info(const std::filesystem::path& directory);

/// Reads the contents of a BOP scene directory without its images. The sequence has no poses unless all views have
/// cam_R_w2c.
[[nodiscard]] Result<SequenceTable> read_bop_scene(const std::filesystem::path& directory);

}  // namespace resight::io
