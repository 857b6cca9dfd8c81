// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <string_view>

namespace resight::report {

/// A name as plain text within Markdown: it cannot end a cell of a table, become a link or a tag, or start a line.
/// Underscores within words stay, because they mean nothing there.
[[nodiscard]] std::string escape_markdown(std::string_view name);

}  // namespace resight::report
