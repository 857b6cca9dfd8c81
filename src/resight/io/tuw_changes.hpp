// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "resight/core/result.hpp"

namespace resight {

/// One annotation that a chain refers to: `<view>_<object>_<instance>.txt`.
struct ChangeChainEntry {
  std::string view;     ///< As written: "cloud_03" or "00003".
  int view_number = 0;  ///< Its number: 3.
  std::string object;
  int instance = 0;  ///< May differ from view to view; the chain says that it is the same thing.
};

/// One physical placement of one object that stays as it is over the listed views. Moved or exchanged = a new chain.
struct ChangeChain {
  std::vector<ChangeChainEntry> entries;  ///< In order of views; at least one.
};

/// Reads a `.changes` file: one chain a line. Lenient: any blanks, empty lines, any number of digits, with or without
/// ".txt". Strict: one object per chain, views ascend, no annotation in two chains.
[[nodiscard]] Result<std::vector<ChangeChain>> read_changes(const std::filesystem::path& file);
[[nodiscard]] Result<std::vector<ChangeChain>> parse_changes(std::string_view text, std::string_view name);

/// Writes the chains by object, first view and first instance, single blanks, final newline: as V4R's tools expect it.
[[nodiscard]] Result<void> write_changes(const std::filesystem::path& file, std::vector<ChangeChain> chains);

}  // namespace resight
