// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <string_view>

namespace resight {

/// The text with every byte that could control a terminal or forge a line as \xNN: control characters (line ends
/// included), marks that reverse the direction of writing, line separators, and bytes that are not valid UTF-8.
[[nodiscard]] std::string printable(std::string_view text);

/// The same for a line of JSON, which stays JSON of the same content: what is harmful in its strings becomes \uNNNN.
[[nodiscard]] std::string printable_json(std::string_view line);

}  // namespace resight
