// SPDX-License-Identifier: Apache-2.0
// Which changes the history of objects misses or tells wrongly: replays it over the detections of a run, and prints
// what the views show of each change that it did not tell, and each event that is none.
//   resight recognize --models models.resight --sequence validation/test/000001 --config all.toml --out run
//   bench_event_losses validation/test/000001 models.resight run/detections.json validation/test/000001.events.json
// all.toml: min_reported_share = 0, for the history sees what the newest view does not show, too.
#include <fmt/format.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "arguments.hpp"
#include "resight/evaluation/event_score.hpp"
#include "resight/io/sequence.hpp"
#include "resight/models/library_file.hpp"
#include "resight/recognition/object_history.hpp"

namespace {

using namespace resight;
using Json = nlohmann::json;

Rigid3 pose_of(const Json& json) {
  Rigid3 pose;
  for (int i = 0; i < 9; ++i) pose.rotation(i / 3, i % 3) = json["rotation"][static_cast<std::size_t>(i)];
  for (int i = 0; i < 3; ++i) pose.translation[i] = json["translation_m"][static_cast<std::size_t>(i)];
  return pose;
}

Detection detection_of(const Json& json, const ModelLibrary& library) {
  Detection detection;
  detection.object = library.find(json["object"]);
  detection.score = json["score"];
  detection.visible_share = json["visible_share"];
  detection.world_from_object = pose_of(json["world_from_object"]);
  for (const Json& e : json["evidence"])
    detection.views.push_back({e["view"], e["allowed"], e["visible_share"], e["explained_share"]});
  return detection;
}

std::string place(const std::optional<Rigid3>& pose) {
  if (!pose) return "-";
  const Eigen::Vector3d& p = pose->translation;
  return fmt::format("({:.2f} {:.2f} {:.2f})", p.x(), p.y(), p.z());
}

void print(const std::string& what, int view, ObjectEventKind kind, const std::string& object,
           const std::optional<Rigid3>& before, const std::optional<Rigid3>& after) {
  fmt::print("{} view {:2} {:8} {:14} {} -> {}", what, view, to_string(kind), object, place(before), place(after));
}

/// Views from `first` to before `last` that recognise an object at a place.
std::string views_with(const std::string& object, const std::optional<Rigid3>& pose, int first, int last,
                       const std::vector<std::vector<Detection>>& detections, const ModelLibrary& library) {
  const int index = library.find(object);
  std::string views;
  for (int v = std::max(0, first); pose && v < std::min(last, static_cast<int>(detections.size())); ++v)
    for (const Detection& d : detections[static_cast<std::size_t>(v)])
      if (d.object == index &&
          is_within(compare_poses(d.world_from_object, *pose, library.objects[static_cast<std::size_t>(index)]), {}))
        views += fmt::format(" {}{}", v, d.views.back().confirmed_share() < 0.01 ? "?" : "");
  return views;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 5) exit_with("usage: bench_event_losses SEQUENCE LIBRARY DETECTIONS.json EVENTS.json [preset]");
  const auto sequence = value_or_exit(open_sequence(argv[1]));
  const ModelLibrary library = value_or_exit(load_library(argv[2]));
  std::ifstream file(argv[3]);
  const Json run = Json::parse(file);
  const SequenceTruth truth = value_or_exit(read_sequence_truth(*sequence, library, argv[4], ""));
  ObjectHistory history(library, preset_or_exit(argc > 5 ? argv[5] : "default").history);
  ChangeSightFinder sights(library, truth);
  std::vector<std::vector<ObjectEvent>> events;
  std::vector<std::vector<Detection>> all_detections;
  for (int v = 0; v < sequence->num_views(); ++v) {
    RgbdFrame frame = value_or_exit(sequence->read_view(v));
    sights.add_view(frame);
    const Json& view = run["views"].at(static_cast<std::size_t>(v));
    frame.world_from_camera = pose_of(view["world_from_camera"]);
    std::vector<Detection> detections;
    for (const Json& detection : view["detections"]) detections.push_back(detection_of(detection, library));
    events.push_back(history.update(v, detections, frame, true));
    all_detections.push_back(std::move(detections));
  }
  events.push_back(history.finish());
  std::vector<std::vector<ObjectEvent>*> all;
  for (auto& e : events) all.push_back(&e);
  drop_replaced(all);

  std::vector<ReportedChange> reported;
  for (const auto& of_view : events)
    for (const ObjectEvent& e : of_view)
      if (is_change(e.kind))
        reported.push_back({e.view, e.kind, library.objects[static_cast<std::size_t>(e.object)].name,
                            e.world_from_object_before, e.world_from_object_after});
  const auto& changes = *truth.changes;
  const EventScore whole = score_events(changes, sights.sights(), reported, library);
  const auto hits = [&](std::span<const TrueChange> c, std::span<const ChangeSight> s) {
    return score_events(c, s, reported, library).events.true_positives;
  };
  // A change is told if it fits a report; a report is right if it fits a change. (One to one in the score.)
  for (std::size_t i = 0; i < changes.size(); ++i) {
    const std::span one(&changes[i], 1);
    const ChangeSight& s = sights.sights()[i];
    const EventScore score = score_events(one, std::span(&s, 1), reported, library);
    if (score.events.false_negatives == 0 || hits(one, std::span(&s, 1)) > 0) continue;
    const TrueChange& c = changes[i];
    print("missed", c.view, c.kind, c.object, c.world_from_object_before, c.world_from_object_after);
    fmt::print(" | there until {} free until {} left seen {} come seen {} | there:{} / {} here: {} / {}\n",
               s.last_there_view, s.last_free_view, s.before_view, s.after_view,
               views_with(c.object, c.world_from_object_before, c.view - 8, c.view, all_detections, library),
               views_with(c.object, c.world_from_object_before, c.view, c.view + 8, all_detections, library),
               views_with(c.object, c.world_from_object_after, c.view - 8, c.view, all_detections, library),
               views_with(c.object, c.world_from_object_after, c.view, c.view + 8, all_detections, library));
  }
  for (const ReportedChange& r : reported) {
    const EventScore score = score_events(changes, sights.sights(), std::span(&r, 1), library);
    if (score.events.false_positives == 0) continue;
    print("wrong ", r.view, r.kind, r.object, r.world_from_object_before, r.world_from_object_after);
    fmt::print(" | departure {} arrival {}\n", score.departures.true_positives, score.arrivals.true_positives);
  }
  fmt::print("told {} wrong {} missed {}\n", whole.events.true_positives, whole.events.false_positives,
             whole.events.false_negatives);
  return 0;
}
