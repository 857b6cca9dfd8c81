// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <functional>
#include <stdexcept>
#include <string>
#include <vector>

#include "resight/core/options.hpp"
#include "resight/core/result.hpp"

namespace resight {

/// Sets options to the values of a TOML file. `list_all` lists them (list_options()); it is called again after each
/// choice, which decides which other options there are. Nested tables are nested groups: key a.b.c is `c` in [a.b].
/// Fails for what is no TOML, unknown keys (naming the nearest known one), wrong types, and keys without effect; some
/// options may then be set already.
[[nodiscard]] Result<void> assign_settings(const std::filesystem::path& file,
                                           const std::function<std::vector<Option>()>& list_all);

/// The options with the values of a TOML file in place of theirs, checked by Options::check(). The error names file,
/// key and rule.
template <typename Options>
[[nodiscard]] Result<Options> read_settings(const std::filesystem::path& file, Options options) {
  if (auto assigned = assign_settings(file, [&] { return list_options(options); }); !assigned) return assigned.error();
  try {
    options.check();
  } catch (const std::invalid_argument& error) {
    return Error{file.string() + ": " + error.what()};
  }
  return options;
}

}  // namespace resight
