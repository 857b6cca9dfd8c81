// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <nlohmann/json_fwd.hpp>
#include <string_view>

#include "resight/core/result.hpp"
#include "resight/geometry/symmetry.hpp"

namespace resight::io {

/// Parses the keys symmetries_discrete and symmetries_continuous of an entry of models_info.json (mm in the file).
[[nodiscard]] Result<ObjectSymmetries> parse_symmetries(const nlohmann::json& json, std::string_view what);
/// Adds these keys to an entry.
void add_symmetries(nlohmann::json& json, const ObjectSymmetries& symmetries);

}  // namespace resight::io
