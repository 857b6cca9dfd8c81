// SPDX-License-Identifier: Apache-2.0
#include "resight/io/recognition_results.hpp"

#include <algorithm>

#include "resight/core/unfinished_folder.hpp"
#include "resight/io/internal/member_reader.hpp"

namespace resight {
namespace {

using io::as_numbers;
using io::as_text;
using io::Faults;
using io::member;
using io::MemberReader;
using nlohmann::json;

constexpr const char* kDetectionsFile = "detections.json";
constexpr const char* kChangesFile = "changes.json";
constexpr const char* kSummaryFile = "summary.json";

std::optional<std::array<double, 36>> read_covariance(const MemberReader& reader) {
  const json& uncertainty = reader["uncertainty"];
  if (uncertainty.is_null()) return std::nullopt;
  const auto numbers = as_numbers(member(uncertainty, "covariance"));
  std::array<double, 36> covariance{};
  if (!numbers || numbers->size() != covariance.size()) {
    reader.fault("uncertainty", "expected a covariance of 36 numbers");
    return std::nullopt;
  }
  std::ranges::copy(*numbers, covariance.begin());
  return covariance;
}

StoredDetection read_detection(const MemberReader& reader) {
  StoredDetection detection;
  detection.object = reader.name("object");
  detection.bop_id = reader.integer("obj_id");
  detection.track = reader.integer("track");
  detection.score = reader.share("score");
  detection.fit = reader.share("fit");
  detection.visible_share = reader.share("visible_share");
  detection.world_from_object = reader.pose("world_from_object");
  detection.covariance = read_covariance(reader);
  if (!reader["verdict"].is_null()) detection.verdict = reader.text("verdict");
  reader.each("evidence", [&](const MemberReader& item) {
    detection.evidence.push_back({item.integer("view"), item.flag("allowed"), item.share("visible_share"),
                                  item.share("explained_share"), item.share("color_share")});
  });
  return detection;
}

Result<RecognitionResults> parse_detections(const std::filesystem::path& file) {
  const auto content = io::read_json(file);
  if (!content) return content.error();
  Faults faults(file);
  const MemberReader reader(*content, "", faults);
  RecognitionResults results;
  results.version = reader.text("version");
  results.preset = reader.text("preset");
  reader.each("views", [&](const MemberReader& item) {
    StoredView view;
    view.name = item.text("name");
    view.world_from_camera = item.pose("world_from_camera");
    if (item.integer("view") != static_cast<int>(results.views.size())) item.fault("view", "views are not in order");
    item.each("detections", [&](const MemberReader& d) { view.detections.push_back(read_detection(d)); });
    results.views.push_back(std::move(view));
  });
  if (faults.first()) return *faults.first();
  return results;
}

StoredEvent read_event(const MemberReader& reader, int num_views) {
  StoredEvent event;
  event.view = reader.integer("view");
  event.kind = reader.text("kind");
  event.object = reader.name("object");
  event.track = reader.integer("track");
  event.world_from_object_before = reader.optional_pose("world_from_object_before");
  event.world_from_object_after = reader.optional_pose("world_from_object_after");
  event.confidence = reader.share("confidence");
  static constexpr const char* kKinds[] = {"found", "added", "moved", "removed", "still_there", "not_seen"};
  if (std::ranges::find(kKinds, event.kind) == std::end(kKinds)) reader.fault("kind", "is no kind of event");
  if (event.view < 0 || event.view >= num_views) reader.fault("view", "is no view of detections.json");
  return event;
}

Result<void> add_changes(const std::filesystem::path& file, RecognitionResults& results) {
  const auto content = io::read_json(file);
  if (!content) return content.error();
  Faults faults(file);
  const MemberReader reader(*content, "", faults);
  const int num_views = static_cast<int>(results.views.size());
  reader.each("events", [&](const MemberReader& item) { results.events.push_back(read_event(item, num_views)); });
  std::size_t index = 0;
  reader.each("views", [&](const MemberReader& item) {
    if (index >= results.views.size() || item.text("name") != results.views[index].name) {
      item.fault("name", "differs from detections.json");
      return;
    }
    StoredView& view = results.views[index++];
    view.num_novel_points = item.count("novel_points");
    view.num_removed_points = item.count("removed_points");
    view.changed_share = item.share("changed_share");
    view.pose_suspect = item.flag("pose_suspect");
  });
  if (index != results.views.size()) reader.fault("views", "has fewer views than detections.json");
  if (faults.first()) return *faults.first();
  std::ranges::stable_sort(results.events, {}, &StoredEvent::view);
  return {};
}

Result<void> add_inputs(const std::filesystem::path& file, RecognitionResults& results) {
  const auto content = io::read_json(file);
  if (!content) return content.error();
  const json& inputs = member(*content, "inputs");
  const auto path_of = [&](const char* key) {
    const std::filesystem::path path = as_text(member(inputs, key)).value_or("");
    return path.empty() ? path : (file.parent_path() / path).lexically_normal();
  };
  results.sequence = path_of("sequence");
  results.models = path_of("models");
  const json& options = member(inputs, "sequence_options");
  if (!options.is_array()) return {};
  std::string option;
  for (const json& name_or_value : options) {
    const std::string text = as_text(name_or_value).value_or("");
    const std::filesystem::path as_file = file.parent_path() / text;
    const bool is_file = may_name_file(option, text) && io::is_file(as_file);
    results.sequence_options.push_back(is_file ? as_file.lexically_normal().string() : text);
    option = text;
  }
  return {};
}

}  // namespace

bool may_name_file(std::string_view option, std::string_view value) {
  return option == "--intrinsics" || option == "--depth-intrinsics" || option == "--color-from-depth" ||
         (option == "--poses" && value != "fixed");
}

bool has_recognition_results(const std::filesystem::path& folder) { return io::is_file(folder / kDetectionsFile); }

Result<RecognitionResults> read_recognition_results(const std::filesystem::path& folder) {
  if (const auto finished = check_finished(folder); !finished) return finished.error();
  auto results = parse_detections(folder / kDetectionsFile);
  if (!results) return results;
  if (const auto added = add_changes(folder / kChangesFile, *results); !added) return added.error();
  if (io::is_file(folder / kSummaryFile))
    if (const auto added = add_inputs(folder / kSummaryFile, *results); !added) return added.error();
  if (io::is_file(folder / kTraceFile)) {
    auto trace = TraceFile::open(folder / kTraceFile, static_cast<int>(results->views.size()));
    if (!trace) return trace.error();
    results->trace = *std::move(trace);
  }
  return results;
}

}  // namespace resight
