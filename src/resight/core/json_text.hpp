// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>

namespace resight {

/// One value a line, indented by one blank.
inline constexpr int kIndentedJson = 1;

/// The text of a JSON value (nlohmann::basic_json), in one line or with an indent. Names of files need not be UTF-8,
/// but JSON must be: other bytes are replaced.
template <typename Json>
[[nodiscard]] std::string to_json_text(const Json& json, int indent = -1) {
  return json.dump(indent, ' ', false, Json::error_handler_t::replace);
}

}  // namespace resight
