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
  kFound,       ///< Recognised for the first time; it is unknown since when it has been there.
  kAdded,       ///< Recognised where an earlier view saw free space, or another object.
  kMoved,       ///< Recognised at a new place; its old place is seen free (or out of sight).
  kRemoved,     ///< Its place is seen free or occupied by another object, and it is not recognised elsewhere.
  kStillThere,  ///< Recognised at its previous place.
  kNotSeen,     ///< Not recognised, without evidence that it has left.
};
[[nodiscard]] std::string to_string(ObjectEventKind kind);
/// True for kAdded, kMoved and kRemoved: the scene has changed.
[[nodiscard]] bool is_change(ObjectEventKind kind);

/// An event that a later one supersedes: the object removed here is found elsewhere, so it has moved, or the pose of an
/// arrival is corrected. Of several events that agree in all fields, it is the last one: a track may move twice in one
/// view, on to a third place.
struct SupersededEvent {
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
  std::optional<SupersededEvent> supersedes{};     ///< kMoved, kAdded and kStillThere only.
};

/// Drops each event that a later one supersedes, given the events of each view of a run.
void drop_superseded(std::span<std::vector<ObjectEvent>> events_of_views);

}  // namespace resight
