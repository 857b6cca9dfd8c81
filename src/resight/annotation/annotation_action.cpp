// SPDX-License-Identifier: Apache-2.0
#include "resight/annotation/annotation_action.hpp"

#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "resight/annotation/annotation_json.hpp"
#include "resight/core/json_integer.hpp"
#include "resight/core/json_text.hpp"
#include "resight/io/parse_json.hpp"

namespace resight {

using nlohmann::json;

namespace annotation {
namespace {

constexpr double kMaxRepair = 0.01;
constexpr double kExact = 1e-12;
constexpr std::size_t kMaxTextBytes = 300;  // A title holds the name of an object, which may have 200 bytes.

constexpr std::array<std::pair<RegionVerdict, std::string_view>, 3> kVerdicts{
    {{RegionVerdict::kOpen, "open"}, {RegionVerdict::kAccepted, "accepted"}, {RegionVerdict::kRejected, "rejected"}}};
constexpr std::array<std::pair<RegionKind, std::string_view>, 2> kRegionKinds{
    {{RegionKind::kNovel, "novel"}, {RegionKind::kRemoved, "removed"}}};
constexpr std::array<std::pair<AnnotatedEventKind, std::string_view>, 3> kKinds{
    {{AnnotatedEventKind::kAdded, "added"},
     {AnnotatedEventKind::kMoved, "moved"},
     {AnnotatedEventKind::kRemoved, "removed"}}};

/// Reads members of an object; remembers whether all were there and of the right type.
class Reader {
 public:
  explicit Reader(const json& object) : object_(object), is_valid_(object.is_object()) {}
  [[nodiscard]] bool is_valid() const { return is_valid_; }

  int integer(const char* key, std::optional<int> missing = std::nullopt) {
    const json& value = find(key);
    if (value.is_null() && missing) return *missing;
    constexpr int kLargest = std::numeric_limits<int>::max() / 2;
    const auto number = json_integer(value, -kLargest, kLargest);
    return number ? *number : fail(0);
  }
  bool boolean(const char* key) {
    const json& value = find(key);
    return value.is_boolean() ? value.get<bool>() : fail(false);
  }
  std::string text(const char* key) {
    const json& value = find(key);
    if (!value.is_string() || value.get_ref<const std::string&>().size() > kMaxTextBytes) return fail(std::string());
    return value.get<std::string>();
  }
  Rigid3 pose(const char* key) {
    const auto pose = pose_from_json(find(key));
    return pose ? *pose : fail(Rigid3());
  }
  std::optional<Eigen::Vector3d> point(const char* key) {
    const json& value = find(key);
    if (value.is_null()) return std::nullopt;
    if (!value.is_array() || value.size() != 3) return fail(std::nullopt);
    Eigen::Vector3d point;
    for (int i = 0; i < 3; ++i) {
      const json& number = value[static_cast<std::size_t>(i)];
      if (!number.is_number() || !std::isfinite(number.get<double>())) return fail(std::nullopt);
      point[i] = number.get<double>();
    }
    return point;
  }
  RegionKey region(const char* key) {
    Reader inside(find(key));
    const RegionKey region{.view = inside.integer("view"),
                           .kind = inside.choice("kind", kRegionKinds),
                           .center_in_world_m = inside.point("center").value_or(Eigen::Vector3d::Constant(NAN))};
    return inside.is_valid() && region.center_in_world_m.allFinite() ? region : fail(region);
  }
  std::optional<PixelRuns> runs(const char* key) {
    const json& numbers = find(key);
    if (numbers.is_null()) return std::nullopt;
    auto runs = runs_from_json(numbers);
    return runs ? runs : fail(runs);
  }
  template <typename Enum, std::size_t kCount>
  Enum choice(const char* key, const std::array<std::pair<Enum, std::string_view>, kCount>& names) {
    const std::string name = text(key);
    for (const auto& [value, known] : names)
      if (known == name) return value;
    return fail(names.front().first);
  }

 private:
  [[nodiscard]] const json& find(const char* key) const {
    static const json kNone;
    if (!object_.is_object()) return kNone;
    const auto found = object_.find(key);
    return found == object_.end() ? kNone : *found;
  }
  template <typename T>
  T fail(T value) {
    is_valid_ = false;
    return value;
  }
  const json& object_;
  bool is_valid_;
};

json change_to_json(const PutObject& change) {
  const AnnotatedObject& o = change.object;
  return {{"do", "put_object"},
          {"id", o.id},
          {"track", o.track},
          {"object", o.object},
          {"first_view", o.first_view},
          {"last_view", o.last_view},
          {"pose", pose_to_json(o.world_from_object)}};
}
json change_to_json(const DropObject& change) { return {{"do", "drop_object"}, {"id", change.id}}; }
json change_to_json(const JudgeRegion& change) {
  const RegionJudgement& j = change.judgement;
  json mask = nullptr;
  if (j.mask) mask = runs_to_json(*j.mask);
  return {{"do", "judge_region"},
          {"region", region_to_json(j.region)},
          {"verdict", to_text(j.verdict)},
          {"track", j.track},
          {"mask", std::move(mask)}};
}
json change_to_json(const CheckView& change) {
  return {{"do", "check_view"}, {"view", change.view}, {"is_checked", change.is_checked}};
}
json change_to_json(const PutUnknownEvent& change) {
  const UnknownObjectEvent& e = change.event;
  return {{"do", "put_event"},
          {"id", e.id},
          {"view", e.view},
          {"kind", to_text(e.kind)},
          {"name", e.name},
          {"before", point_to_json(e.before_in_world_m)},
          {"after", point_to_json(e.after_in_world_m)}};
}
json change_to_json(const DropUnknownEvent& change) { return {{"do", "drop_event"}, {"id", change.id}}; }

std::optional<AnnotationChange> change_from_json(const json& text) {
  Reader read(text);
  const std::string what = read.text("do");
  AnnotationChange change;
  if (what == "put_object") {
    change = PutObject{{.id = read.integer("id", -1),
                        .track = read.integer("track", -1),
                        .object = read.integer("object"),
                        .first_view = read.integer("first_view"),
                        .last_view = read.integer("last_view"),
                        .world_from_object = read.pose("pose")}};
  } else if (what == "drop_object") {
    change = DropObject{read.integer("id")};
  } else if (what == "judge_region") {
    change = JudgeRegion{{.region = read.region("region"),
                          .verdict = read.choice("verdict", kVerdicts),
                          .track = read.integer("track", -1),
                          .mask = read.runs("mask")},
                         !text.contains("mask")};
  } else if (what == "check_view") {
    change = CheckView{read.integer("view"), read.boolean("is_checked")};
  } else if (what == "put_event") {
    change = PutUnknownEvent{{.id = read.integer("id", -1),
                              .view = read.integer("view"),
                              .kind = read.choice("kind", kKinds),
                              .name = read.text("name"),
                              .before_in_world_m = read.point("before"),
                              .after_in_world_m = read.point("after")}};
  } else if (what == "drop_event") {
    change = DropUnknownEvent{read.integer("id")};
  } else {
    return std::nullopt;
  }
  return read.is_valid() ? std::optional(change) : std::nullopt;
}

}  // namespace

json pose_to_json(const Rigid3& pose) {
  const Eigen::Matrix4d matrix = pose.matrix();  // stored column by column
  return std::vector<double>(matrix.data(), matrix.data() + matrix.size());
}

json point_to_json(const std::optional<Eigen::Vector3d>& point_m) {
  if (!point_m) return nullptr;
  return {point_m->x(), point_m->y(), point_m->z()};
}

json region_to_json(const RegionKey& region) {
  return {{"view", region.view}, {"kind", to_string(region.kind)}, {"center", point_to_json(region.center_in_world_m)}};
}

json runs_to_json(const PixelRuns& runs) {
  json numbers = json::array();
  for (const PixelRun& run : runs) {
    numbers.push_back(run.first);
    numbers.push_back(run.count);
  }
  return numbers;
}

std::optional<PixelRuns> runs_from_json(const json& numbers) {
  if (!numbers.is_array() || numbers.size() % 2 != 0) return std::nullopt;
  PixelRuns runs;
  for (std::size_t i = 0; i < numbers.size(); i += 2) {
    const auto pixel = [&](const json& number) {
      return json_integer(number, 0, std::numeric_limits<int>::max()).value_or(-1);
    };
    runs.push_back({pixel(numbers[i]), pixel(numbers[i + 1])});
  }
  if (!check_runs(runs)) return std::nullopt;
  return runs;
}

std::optional<Rigid3> pose_from_json(const json& numbers) {
  if (!numbers.is_array() || numbers.size() != 16) return std::nullopt;
  Eigen::Matrix4d matrix;
  for (Eigen::Index i = 0; i < 16; ++i) {
    const json& number = numbers[static_cast<std::size_t>(i)];
    if (!number.is_number()) return std::nullopt;
    matrix.data()[i] = number.get<double>();
  }
  Rigid3 pose = Rigid3::from_matrix(matrix);
  if (!matrix.allFinite() || !pose.is_rigid(kMaxRepair)) return std::nullopt;
  if (!pose.is_rigid(kExact)) pose.rotation = nearest_rotation(pose.rotation);
  return pose;
}

std::string_view to_text(RegionVerdict verdict) { return kVerdicts[static_cast<std::size_t>(verdict)].second; }
std::string_view to_text(AnnotatedEventKind kind) { return kKinds[static_cast<std::size_t>(kind)].second; }

}  // namespace annotation

std::string format_action(const AnnotationAction& action) {
  if (std::holds_alternative<UndoEdit>(action)) return "\"undo\"";
  if (std::holds_alternative<RedoEdit>(action)) return "\"redo\"";
  const auto& edit = std::get<AnnotationEdit>(action);
  json changes = json::array();
  for (const AnnotationChange& change : edit.changes)
    changes.push_back(std::visit([](const auto& one) { return annotation::change_to_json(one); }, change));
  const json line = {{"title", edit.title}, {"changes", std::move(changes)}};
  return to_json_text(line);
}

Result<AnnotationAction> parse_action(std::string_view text) {
  const auto value = parse_json(text);
  if (!value) return Error{"the action " + value.error().message};
  const json& parsed = *value;
  if (parsed == "undo") return AnnotationAction(UndoEdit{});
  if (parsed == "redo") return AnnotationAction(RedoEdit{});
  annotation::Reader read(parsed);
  AnnotationEdit edit{.title = read.text("title"), .changes = {}};
  if (!read.is_valid()) return Error{"an action is \"undo\", \"redo\", or an object with a title and changes"};
  const auto changes = parsed.find("changes");
  if (changes == parsed.end() || !changes->is_array() || changes->empty())
    return Error{"an edit has at least one change"};
  for (const json& one : *changes) {
    auto change = annotation::change_from_json(one);
    if (!change) return Error{"a change has an unknown name, a missing value, or one that is not finite or not rigid"};
    edit.changes.push_back(*std::move(change));
  }
  return AnnotationAction(std::move(edit));
}

}  // namespace resight
