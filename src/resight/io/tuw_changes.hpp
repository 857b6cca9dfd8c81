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

/// A chain in terms of a sequence: the views are numbers from 0, in the order of time.
struct ObjectPlacement {
  struct Entry {
    int view = 0;
    int instance = 0;  ///< GroundTruthObject::instance in this view.
    friend bool operator==(const Entry&, const Entry&) = default;
  };
  std::string object;
  std::vector<Entry> entries;  ///< In order of views; at least one.
  friend bool operator==(const ObjectPlacement&, const ObjectPlacement&) = default;
};

/// Finds the views of the chains among the names `views` of a sequence: by name with any number of digits
/// ("cloud_003" is "cloud_03"), else by number, as the tools of V4R do ("00003" is "cloud_03"). The error names `name`
/// and the annotation whose view is missing, ambiguous or not after its predecessor.
[[nodiscard]] Result<std::vector<ObjectPlacement>> resolve_changes(const std::vector<ChangeChain>& chains,
                                                                   const std::vector<std::string>& views,
                                                                   std::string_view name);
/// The reverse: chains with the names `views`.
[[nodiscard]] std::vector<ChangeChain> name_placements(const std::vector<ObjectPlacement>& placements,
                                                       const std::vector<std::string>& views);

/// Reads a `.changes` file with one chain per line. Accepts any blanks, empty lines, any number of digits, and names
/// with or without ".txt". Requires one object per chain, ascending views, and no annotation in two chains.
[[nodiscard]] Result<std::vector<ChangeChain>> read_changes(const std::filesystem::path& file);
/// Same from memory. `name` is used in error messages.
[[nodiscard]] Result<std::vector<ChangeChain>> parse_changes(std::string_view text, std::string_view name);

/// The text of a `.changes` file; see write_changes().
[[nodiscard]] std::string format_changes(std::vector<ChangeChain> chains);
/// Writes the chains by object, first view and first instance, with single blanks and a final newline, as the tools of
/// V4R expect.
[[nodiscard]] Result<void> write_changes(const std::filesystem::path& file, std::vector<ChangeChain> chains);

}  // namespace resight
