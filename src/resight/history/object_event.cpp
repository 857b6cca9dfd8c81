// SPDX-License-Identifier: Apache-2.0
#include "resight/history/object_event.hpp"

#include <map>
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
  std::map<Key, const ObjectEvent*> last;
  std::set<const ObjectEvent*> superseded;
  for (const std::vector<ObjectEvent>& events : events_of_views)
    for (const ObjectEvent& event : events) {
      if (const auto& s = event.supersedes)
        if (const auto it = last.find({s->kind, s->track, s->view}); it != last.end()) superseded.insert(it->second);
      last[{event.kind, event.track, event.view}] = &event;
    }
  for (std::vector<ObjectEvent>& events : events_of_views)  // Each event is still at its address when it is tested.
    std::erase_if(events, [&](const ObjectEvent& e) { return superseded.contains(&e); });
}

}  // namespace resight
