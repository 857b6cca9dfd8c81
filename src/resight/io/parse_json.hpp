// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <nlohmann/json.hpp>
#include <string_view>

#include "resight/core/result.hpp"

namespace resight {

/// Limit for the values of a text. Poses of a million objects take 0.8 GB, their visibilities 1.2 GB.
inline constexpr std::size_t kMaxJsonBytes = std::size_t{1} << 31;

/// Parses without exceptions. Fails for a key that occurs twice in an object, for lists and objects that are nested
/// more than 64 deep, and for values that would take more than about `max_bytes` of memory. The error says what is
/// wrong, but not where the text comes from.
[[nodiscard]] Result<nlohmann::json> parse_json(std::string_view text, std::size_t max_bytes = kMaxJsonBytes);

}  // namespace resight
