// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>

namespace resight {

/// All options of the recogniser as Markdown, a table per section: key, unit, allowed values, value in each preset,
/// meaning and source. docs/options.md is this text.
[[nodiscard]] std::string options_reference();

}  // namespace resight
