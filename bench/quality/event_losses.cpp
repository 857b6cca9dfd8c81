// SPDX-License-Identifier: Apache-2.0
// Which changes the object history misses or reports wrongly. Replays the history over the detections of a run, and
// prints what the views show of each unreported change, and each wrong event.
//   resight recognize --models models.resight --sequence validation/test/000001 --config all.toml --out run
//   bench_event_losses validation/test/000001 models.resight run/detections.json validation/test/000001.events.json
// all.toml: detections.min_reported_share = 0 and min_score = 0, because the history also uses what is not reported.
#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "arguments.hpp"
#include "resight/evaluation/event_score.hpp"
#include "resight/history/object_history.hpp"
#include "resight/io/sequence.hpp"
#include "resight/models/library_file.hpp"
#include "resight/recognition/scene_update.hpp"

namespace {

using namespace resight;
using Json = nlohmann::json;

Rigid3 pose_of(const Json& json) {
  Rigid3 pose;
  for (std::size_t i = 0; i < 9; ++i)
    pose.rotation(static_cast<int>(i / 3), static_cast<int>(i % 3)) = json.at("rotation").at(i);
  for (std::size_t i = 0; i < 3; ++i) pose.translation[static_cast<int>(i)] = json.at("translation_m").at(i);
  return pose;
}

Detection detection_of(const Json& json, const ModelLibrary& library) {
  Detection detection;
  detection.object = library.find(json.at("object"));
  if (detection.object < 0) exit_with("the library does not hold the objects of the detections");
  detection.score = json.at("score");
  detection.visible_share = json.at("visible_share");
  detection.world_from_object = pose_of(json.at("world_from_object"));
  for (const Json& e : json.at("evidence"))
    detection.views.push_back(
        {e.at("view"), e.at("allowed"), e.at("visible_share"), e.at("explained_share"), e.value("color_share", 0.0)});
  if (detection.views.empty()) exit_with("a detection has no evidence");
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

/// Views from `first` to before `last` in which an object is recognised at a place.
std::string views_with(const std::string& object, const std::optional<Rigid3>& pose, int first, int last,
                       const std::vector<std::vector<Detection>>& detections, const ModelLibrary& library) {
  const int index = library.find(object);
  std::string views;
  for (int v = std::max(0, first); pose && v < std::min(last, static_cast<int>(detections.size())); ++v)
    for (const Detection& d : detections[static_cast<std::size_t>(v)])
      if (d.object == index &&
          is_within(compare_poses(d.world_from_object, *pose, library.objects[static_cast<std::size_t>(index)]), {}))
        views += fmt::format(" {}{}", v, d.views.back().confirmed_share() < 0.002 ? "?" : "");
  return views;
}

/// What the history reports of a run, including later corrections.
struct Replay {
  std::vector<std::vector<Detection>> detections;
  std::vector<ReportedChange> reported;
};

Replay replay(const Sequence& sequence, const Json& run, const ModelLibrary& library, const std::string& preset,
              ChangeVisibilityFinder& visibilities) {
  Replay replay;
  ObjectHistory history(library, preset_or_exit(preset).history);
  std::vector<std::vector<ObjectEvent>> events;
  for (int v = 0; v < sequence.num_views(); ++v) {
    RgbdFrame frame = value_or_exit(sequence.read_view(v));
    visibilities.add_view(frame);
    const Json& view = run.at("views").at(static_cast<std::size_t>(v));
    frame.world_from_camera = pose_of(view.at("world_from_camera"));
    std::vector<Detection> detections;
    for (const Json& detection : view.at("detections")) detections.push_back(detection_of(detection, library));
    std::vector<ObjectObservation> observed;
    for (const Detection& detection : detections) observed.push_back(detection.observation());
    events.push_back(history.update(v, observed, frame, true).events);
    replay.detections.push_back(std::move(detections));
  }
  events.push_back(history.finish());
  drop_superseded(events);
  for (const auto& of_view : events)
    for (const ObjectEvent& e : of_view)
      if (is_change(e.kind))
        replay.reported.push_back({e.view, e.kind, library.objects[static_cast<std::size_t>(e.object)].name,
                                   e.world_from_object_before, e.world_from_object_after});
  std::ranges::stable_sort(replay.reported, {}, &ReportedChange::view);
  return replay;
}

void print_missed(const SeenChange& c, const Replay& replay, const ModelLibrary& library) {
  constexpr int kViews = 8;
  print("missed", c.view, c.kind, c.object, c.world_from_object_before, c.world_from_object_after);
  const auto views = [&](const std::optional<Rigid3>& pose, int first) {
    return views_with(c.object, pose, first, first + kViews, replay.detections, library);
  };
  fmt::print(" | present until {} free until {} departure seen {} arrival seen {} | there:{} /{} here:{} /{}\n",
             c.visibility.last_there_view, c.visibility.last_free_view, c.visibility.before_view,
             c.visibility.after_view, views(c.world_from_object_before, c.view - kViews),
             views(c.world_from_object_before, c.view), views(c.world_from_object_after, c.view - kViews),
             views(c.world_from_object_after, c.view));
}

void print_losses(const Replay& replay, const std::vector<TrueChange>& changes,
                  const std::vector<ChangeVisibility>& visibilities, const ModelLibrary& library) {
  std::vector<SeenChange> truths;
  for (std::size_t i = 0; i < changes.size(); ++i)
    if (changes[i].known && library.find(changes[i].object) >= 0) truths.push_back({changes[i], visibilities[i]});
  std::ranges::stable_sort(truths, {}, &SeenChange::view);
  const MatchDetectionsOptions options;
  const ChangeMatcher matcher(library, options);
  truths = reconcile_with_reports(std::move(truths), replay.reported, matcher);
  const std::vector<int> truth_of = match_in_order(
      truths, replay.reported, [&](const SeenChange& t, const ReportedChange& r) { return matcher.fits(t, r); },
      [](const SeenChange& t) { return t.counts(); });
  for (std::size_t t = 0; t < truths.size(); ++t)
    if (truths[t].counts() && std::ranges::find(truth_of, static_cast<int>(t)) == truth_of.end())
      print_missed(truths[t], replay, library);
  for (std::size_t r = 0; r < replay.reported.size(); ++r) {
    if (truth_of[r] >= 0) continue;
    const ReportedChange& report = replay.reported[r];
    print("wrong ", report.view, report.kind, report.object, report.world_from_object_before,
          report.world_from_object_after);
    const EventScore alone = score_events(changes, visibilities, std::span(&report, 1), library);
    fmt::print(" | departure {} arrival {}\n", alone.departures.true_positives, alone.arrivals.true_positives);
  }
  const RecognitionScore score = score_events(changes, visibilities, replay.reported, library).events;
  fmt::print("reported {} wrong {} missed {}\n", score.true_positives, score.false_positives, score.false_negatives);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 5) exit_with("usage: bench_event_losses SEQUENCE LIBRARY DETECTIONS.json EVENTS.json [preset]");
  const auto sequence = value_or_exit(open_sequence(argv[1]));
  const ModelLibrary library = value_or_exit(load_library(argv[2]));
  const SequenceTruth truth =
      value_or_exit(read_sequence_truth(*sequence, library, {.events = argv[4], .changes = {}}));
  if (!truth.changes) exit_with(fmt::format("no changes in {}", argv[4]));
  ChangeVisibilityFinder visibilities(library, truth);
  try {
    std::ifstream file(argv[3]);
    const Replay run = replay(*sequence, Json::parse(file), library, argc > 5 ? argv[5] : "default", visibilities);
    print_losses(run, *truth.changes, visibilities.visibilities(), library);
  } catch (const Json::exception& error) {
    exit_with(fmt::format("{}: {}", argv[3], error.what()));
  }
  return 0;
}
