// SPDX-License-Identifier: Apache-2.0
#include "resight/io/event_file.hpp"

#include <fmt/format.h>

#include <utility>

#include "resight/core/names.hpp"
#include "resight/io/internal/json.hpp"
#include "resight/io/pose_text.hpp"

namespace resight {
namespace {

using nlohmann::json;

/// 16 numbers row by row, or null.
Result<std::optional<Rigid3>> parse_event_pose(const json& event, const char* key) {
  const json& value = io::member(event, key);
  if (value.is_null()) return std::optional<Rigid3>();
  const auto numbers = io::as_numbers(value);
  if (!numbers || numbers->size() != 16) return Error{fmt::format("{}: expected 16 finite numbers or null", key)};
  const auto pose = rigid_from_numbers(*numbers, key);
  if (!pose) return pose.error();
  return std::optional(*pose);
}

/// What both forms of an entry have.
Result<RecordedEvent> parse_change(const json& view_value, const json& kind_value, const json& object_value,
                                   int num_views) {
  const auto kind = io::as_text(kind_value);
  if (!kind || (*kind != "added" && *kind != "moved" && *kind != "removed"))
    return Error{"kind: expected added, moved or removed"};
  const auto view = io::as_integer(view_value);
  if (!view || *view < 0) return Error{"view: expected a whole number of 0 or more"};
  if (*view >= num_views) return Error{fmt::format("view: {}, but the sequence has {} views", *view, num_views)};
  auto object = io::as_text(object_value);
  if (!object) return Error{"object: expected a text"};
  if (const auto valid = check_object_name(*object); !valid) return Error{"object: " + valid.error().message};
  RecordedEvent event;
  event.view = *view;
  event.kind = *kind;
  event.object = *std::move(object);
  return event;
}

/// [view, kind, object]
Result<RecordedEvent> parse_short_event(const json& value, int num_views) {
  if (value.size() != 3) return Error{"expected an object, or [view, kind, object]"};
  return parse_change(value[0], value[1], value[2], num_views);
}

Result<RecordedEvent> parse_event(const json& value, int num_views) {
  if (value.is_array()) return parse_short_event(value, num_views);
  auto event =
      parse_change(io::member(value, "view"), io::member(value, "kind"), io::member(value, "object"), num_views);
  if (!event) return event;
  const json& known = io::member(value, "known");
  if (!known.is_boolean()) return Error{"known: expected true or false"};
  event->known = known.get<bool>();
  const auto before = parse_event_pose(value, "world_from_object_before");
  if (!before) return before.error();
  const auto after = parse_event_pose(value, "world_from_object_after");
  if (!after) return after.error();
  if (before->has_value() != (event->kind != "added") || after->has_value() != (event->kind != "removed"))
    return Error{fmt::format("the poses do not match the kind '{}'", event->kind)};
  event->world_from_object_before = *before;
  event->world_from_object_after = *after;
  return event;
}

}  // namespace

Result<std::vector<RecordedEvent>> read_event_file(const std::filesystem::path& file, int num_views) {
  const auto document = io::read_json(file);
  if (!document) return document.error();
  const json& list = io::member(*document, "events");
  if (!list.is_array()) return io::file_error(file, "is not an object with a list of events");
  const json& counted = io::member(*document, "num_views");
  if (const auto count = io::as_integer(counted); !counted.is_null() && count != num_views)
    return io::file_error(file, fmt::format("num_views: differs from the {} views of the sequence", num_views));
  std::vector<RecordedEvent> events;
  for (const json& value : list) {
    auto event = parse_event(value, num_views);
    if (!event) return io::file_error(file, fmt::format("events[{}]: {}", events.size(), event.error().message));
    events.push_back(*std::move(event));
  }
  return events;
}

}  // namespace resight
