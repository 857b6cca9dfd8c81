// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <string>
#include <vector>

namespace resight {

/// The files that state the true changes of a sequence. A path is empty if there is no such file. It may name what
/// cannot be read, such as a link that leads nowhere.
struct ChangeFiles {
  std::filesystem::path events;   ///< JSON, see read_event_file().
  std::filesystem::path changes;  ///< Chains of annotations (`.changes` of TUW, tuw_changes.hpp).
  [[nodiscard]] bool empty() const { return events.empty() && changes.empty(); }
};

/// Finds the change files of the sequence in the folder `sequence`; docs/formats.md lists the places. `views` are the
/// names of its views, which identify the folder of its annotations.
[[nodiscard]] ChangeFiles find_change_files(const std::filesystem::path& sequence,
                                            const std::vector<std::string>& views);

}  // namespace resight
