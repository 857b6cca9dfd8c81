// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <concepts>
#include <cstdint>
#include <limits>
#include <optional>

namespace resight {

/// The value of a JSON number (nlohmann::basic_json) that is whole, from `least` to `largest`; none for all other
/// values. The library itself does not check: a number beyond the type is undefined behaviour.
template <std::integral Integer, typename Json>
[[nodiscard]] std::optional<Integer> json_integer(const Json& json, Integer least, Integer largest) {
  if (!json.is_number_integer()) return std::nullopt;
  if (json.is_number_unsigned() &&
      json.template get<std::uint64_t>() > std::uint64_t{std::numeric_limits<std::int64_t>::max()})
    return std::nullopt;
  const auto number = json.template get<std::int64_t>();
  return number >= least && number <= largest ? std::optional(static_cast<Integer>(number)) : std::nullopt;
}

}  // namespace resight
