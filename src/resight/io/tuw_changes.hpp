// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "resight/core/result.hpp"

namespace resight {

/// One annotation in a chain: `<view>_<object>_<instance>.txt`.
struct ChangeChainEntry {
  std::string view;     ///< As in the file: "cloud_03" or "00003".
  int view_number = 0;  ///< Number of the view: 3.
  std::string object;
  int instance = 0;  ///< May differ between views. The chain states that they are the same object.
};

/// One physical placement of one object that does not change over the listed views. A moved or exchanged object starts
/// a new chain.
struct ChangeChain {
  std::vector<ChangeChainEntry> entries;  ///< In order of views; at least one.
};

/// Reads a `.changes` file with one chain per line. Accepts any blanks, empty lines, any number of digits, and names
/// with or without ".txt". Requires one object per chain, ascending views, and no annotation in two chains.
[[nodiscard]] Result<std::vector<ChangeChain>> read_changes(const std::filesystem::path& file);
/// Same from memory. `name` is used in error messages.
[[nodiscard]] Result<std::vector<ChangeChain>> parse_changes(std::string_view text, std::string_view name);

/// Writes the chains by object, first view and first instance, with single blanks and a final newline, as the tools of
/// V4R expect.
[[nodiscard]] Result<void> write_changes(const std::filesystem::path& file, std::vector<ChangeChain> chains);

}  // namespace resight
