// SPDX-License-Identifier: Apache-2.0
#include "resight/history/object_event.hpp"

#include <set>
#include <tuple>

namespace resight {

std::string to_string(ObjectEventKind kind) {
  switch (kind) {
    case ObjectEventKind::kFound:
      return "found";
    case ObjectEventKind::kAdded:
      return "added";
    case ObjectEventKind::kMoved:
      return "moved";
    case ObjectEventKind::kRemoved:
      return "removed";
    case ObjectEventKind::kStillThere:
      return "still_there";
    case ObjectEventKind::kNotSeen:
      return "not_seen";
  }
  return "unknown";
}

bool is_change(ObjectEventKind kind) {
  return kind == ObjectEventKind::kAdded || kind == ObjectEventKind::kMoved || kind == ObjectEventKind::kRemoved;
}

void drop_superseded(std::span<std::vector<ObjectEvent>> events_of_views) {
  using Key = std::tuple<ObjectEventKind, int, int>;
  std::set<Key> superseded;
  for (const std::vector<ObjectEvent>& events : events_of_views)
    for (const ObjectEvent& event : events)
      if (event.supersedes)
        superseded.insert({event.supersedes->kind, event.supersedes->track, event.supersedes->view});
  for (std::vector<ObjectEvent>& events : events_of_views)
    std::erase_if(events, [&](const ObjectEvent& e) { return superseded.contains(Key{e.kind, e.track, e.view}); });
}

}  // namespace resight
