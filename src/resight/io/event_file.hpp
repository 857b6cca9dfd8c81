// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "resight/core/result.hpp"
#include "resight/geometry/rigid3.hpp"

namespace resight {

/// One entry of events.json (docs/formats.md).
struct RecordedEvent {
  int view = 0;                                    ///< Before which it happened, from 0.
  std::string kind;                                ///< added, moved or removed.
  std::string object;                              ///< Name of the model.
  bool known = true;                               ///< Whether the object is in the library.
  std::optional<Rigid3> world_from_object_before;  ///< Absent for added, and in the short form.
  std::optional<Rigid3> world_from_object_after;   ///< Absent for removed, and in the short form.
};

/// Reads the events of a sequence that has `num_views` views. An event in short form is a list [view, kind, object].
/// Fails for an event of a view that the sequence does not have, a name that check_object_name() refuses, a pose that
/// is not rigid or far away, and poses that do not match the kind. The error names the file and the event, counted from
/// 0.
[[nodiscard]] Result<std::vector<RecordedEvent>> read_event_file(const std::filesystem::path& file, int num_views);

}  // namespace resight
