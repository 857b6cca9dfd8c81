// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "resight/core/result.hpp"
#include "resight/geometry/symmetry.hpp"
#include "resight/io/internal/listed_sequence.hpp"

namespace resight::io {

/// An entry of models_info.json.
struct BopModelInfo {
  std::string name;  ///< Our optional key "name"; else obj_000005.
  ObjectSymmetries symmetries;
};

/// "obj_000005".
[[nodiscard]] std::string bop_object_name(int bop_id);
/// "000012".
[[nodiscard]] std::string bop_number(int number);
/// The number of "obj_000005.ply" (or of its stem); none for other names.
[[nodiscard]] std::optional<int> parse_bop_object_name(std::string_view stem);

/// models_info.json by obj_id.
[[nodiscard]] Result<std::map<int, BopModelInfo>> read_models_info(const std::filesystem::path& file);

/// The models_info.json of the data set that `directory` (a scene, split, or the data set itself) is part of: in
/// models, models_eval or another models_* folder at most three levels up.
[[nodiscard]] std::optional<std::filesystem::path> find_models_info(const std::filesystem::path& directory);

/// What a BOP scene directory holds, images not read. Without cam_R_w2c in all views it has no poses.
[[nodiscard]] Result<SequenceTable> read_bop_scene(const std::filesystem::path& directory);

}  // namespace resight::io
