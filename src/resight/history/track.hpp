// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <optional>

#include "resight/geometry/rigid3.hpp"
#include "resight/history/object_event.hpp"

namespace resight {

enum class TrackState : std::uint8_t {
  kPresent,  ///< At its place, as far as is known.
  kLeaving,  ///< Its place was seen free or occupied by another object. The removal is not reported yet.
  kGone,     ///< Its removal is reported.
  kJoined,   ///< Merged into another track; deleted at the end of the view.
};

/// One object over time, confirmed by at least one view. Views are numbers in the sequence; -1: none.
struct Track {
  int id = 0;
  int object = -1;  ///< Index into the ModelLibrary.
  Rigid3 world_from_object;
  int last_view = -1;  ///< Last view in whose window it was recognised.
  TrackState state = TrackState::kPresent;
  int seen_view = -1;                  ///< Last view that recognised it and confirmed it itself.
  int since_view = -1;                 ///< First view that recognised it at its place.
  int reported_view = -1;              ///< View whose event first reported it at its place.
  std::optional<ObjectEvent> arrival;  ///< That event, if its kind is kAdded or kMoved.
  int left_view = -1;                  ///< First view that saw its place free, or occupied by another object.
  bool is_replaced = false;            ///< Another object occupies its place.
  double confidence = 0;               ///< Of its departure, in [0, 1].

  [[nodiscard]] bool was_added() const { return arrival && arrival->kind == ObjectEventKind::kAdded; }
};

/// A place that an object has left for another one.
struct FormerPlacement {
  int object = -1;
  Rigid3 world_from_object;
  int seen_view = -1;  ///< Last view that confirmed it there.
};

}  // namespace resight
