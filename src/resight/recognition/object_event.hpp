// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "resight/geometry/rigid3.hpp"

namespace resight {

enum class ObjectEventKind : std::uint8_t {
  kFound,       ///< Recognised for the first time; nothing tells since when it has been there.
  kAdded,       ///< Recognised where an earlier view saw free space, or another object.
  kMoved,       ///< Recognised at a new place, its old place seen free (or out of sight).
  kRemoved,     ///< Its place seen free, or another object in it, and not recognised elsewhere.
  kStillThere,  ///< Recognised where it was.
  kNotSeen,     ///< Not recognised, and nothing says that it has left.
};
[[nodiscard]] std::string to_string(ObjectEventKind kind);
/// Added, moved or removed: a change of the scene, unlike the other kinds.
[[nodiscard]] bool is_change(ObjectEventKind kind);

/// An event told before that turned out to be part of another (what was removed here turns up there, and has moved), or
/// to be a little otherwise (the pose of what came).
struct ReplacedEvent {
  ObjectEventKind kind = ObjectEventKind::kRemoved;  ///< kRemoved, kAdded or kMoved.
  int track = -1;
  int view = 0;
};

/// What happened to one object of the history at a view.
struct ObjectEvent {
  ObjectEventKind kind = ObjectEventKind::kFound;
  int object = -1;
  int track = -1;
  int view = 0;
  std::optional<Rigid3> world_from_object_before;  ///< kMoved, kRemoved, kStillThere, kNotSeen.
  std::optional<Rigid3> world_from_object_after;   ///< kFound, kAdded, kMoved, kStillThere.
  double confidence = 0;                           ///< In [0, 1].
  std::optional<ReplacedEvent> supersedes{};       ///< kMoved, kAdded and kStillThere only.
};

/// Drops each event that a later one supersedes, given the events of each view of a run.
void drop_superseded(std::span<std::vector<ObjectEvent>> events_of_views);

}  // namespace resight
