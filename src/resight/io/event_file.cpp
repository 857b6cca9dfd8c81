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
  Eigen::Matrix4d matrix;
  for (int row = 0; row < 4; ++row)
    for (int col = 0; col < 4; ++col) matrix(row, col) = (*numbers)[static_cast<std::size_t>(4 * row + col)];
  const auto pose = rigid_from_matrix(matrix, key);
  if (!pose) return pose.error();
  return std::optional(*pose);
}

Result<RecordedEvent> parse_event(const json& value, int num_views) {
  const auto kind = io::as_text(io::member(value, "kind"));
  if (!kind || (*kind != "added" && *kind != "moved" && *kind != "removed"))
    return Error{"kind: expected added, moved or removed"};
  const auto view = io::as_integer(io::member(value, "view"));
  if (!view || *view < 0) return Error{"view: expected a whole number of 0 or more"};
  if (*view >= num_views) return Error{fmt::format("view: {}, but the sequence has {} views", *view, num_views)};
  auto object = io::as_text(io::member(value, "object"));
  if (!object) return Error{"object: expected a text"};
  if (const auto valid = check_object_name(*object); !valid) return Error{"object: " + valid.error().message};
  const json& known = io::member(value, "known");
  if (!known.is_boolean()) return Error{"known: expected true or false"};
  const auto before = parse_event_pose(value, "world_from_object_before");
  if (!before) return before.error();
  const auto after = parse_event_pose(value, "world_from_object_after");
  if (!after) return after.error();
  if (before->has_value() != (*kind != "added") || after->has_value() != (*kind != "removed"))
    return Error{fmt::format("the poses do not match the kind '{}'", *kind)};
  return RecordedEvent{.view = *view,
                       .kind = *kind,
                       .object = *std::move(object),
                       .known = known.get<bool>(),
                       .world_from_object_before = *before,
                       .world_from_object_after = *after};
}

}  // namespace

Result<std::vector<RecordedEvent>> read_event_file(const std::filesystem::path& file, int num_views) {
  const auto document = io::read_json(file);
  if (!document) return document.error();
  const json& list = io::member(*document, "events");
  if (!list.is_array()) return io::file_error(file, "is not an object with a list of events");
  std::vector<RecordedEvent> events;
  for (const json& value : list) {
    auto event = parse_event(value, num_views);
    if (!event) return io::file_error(file, fmt::format("events[{}]: {}", events.size(), event.error().message));
    events.push_back(*std::move(event));
  }
  return events;
}

}  // namespace resight
