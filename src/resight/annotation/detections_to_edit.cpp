// SPDX-License-Identifier: Apache-2.0
#include "resight/annotation/detections_to_edit.hpp"

#include <algorithm>
#include <map>
#include <string_view>

#include "resight/models/pose_distance.hpp"

namespace resight {
namespace {

constexpr SamePlaceOptions kSamePlace{.max_distance_m = 0.03, .max_rotation_rad = 0.35};

// By how much the poses of a view may differ, because the recogniser has corrected them.
constexpr double kMaxCameraShift_m = 0.1;
constexpr double kMaxCameraTurn_rad = 0.2;

/// A detection in the world frame of the sequence.
struct PlacedDetection {
  int view = 0;
  int object = -1;
  double score = 0;
  Rigid3 world_from_object;
};

using DetectionsOfTrack = std::map<int, std::vector<PlacedDetection>>;

Result<std::vector<int>> number_views(const RecognitionResults& results, const Sequence& sequence) {
  std::map<std::string, int> numbers;
  for (int v = 0; v < sequence.num_views(); ++v) numbers.emplace(sequence.view_name(v), v);
  std::vector<int> views;
  for (const StoredView& view : results.views) {
    const auto found = numbers.find(view.name);
    if (found == numbers.end())
      return Error{"the detections are of another sequence: it has no view '" + view.name + "'"};
    views.push_back(found->second);
  }
  return views;
}

/// Many sequences have views 000000, 000001, .. They are the same if at least half of the cameras were where they are
/// said to be. Poses of `--poses auto`, which begin at the identity, have a frame of their own and tell nothing.
Result<void> check_cameras(const RecognitionResults& results, const std::vector<int>& views, const Sequence& sequence) {
  if (results.views.empty() || results.views.front().world_from_camera.matrix().isIdentity(1e-6)) return {};
  std::size_t num_elsewhere = 0;
  for (std::size_t v = 0; v < results.views.size(); ++v) {
    const auto given = sequence.read_pose(views[v]);
    if (!given) return given.error();
    const Rigid3& found = results.views[v].world_from_camera;
    if ((found.translation - given->translation).norm() > kMaxCameraShift_m ||
        rotation_angle_rad(found.rotation, given->rotation) > kMaxCameraTurn_rad)
      ++num_elsewhere;
  }
  if (2 * num_elsewhere <= results.views.size()) return {};
  return Error{"the detections are of another sequence: its cameras were elsewhere in " +
               std::to_string(num_elsewhere) + " of " + std::to_string(results.views.size()) + " views"};
}

/// The recogniser may have corrected the pose of the camera; the annotation is in the frame of the given poses.
Result<Rigid3> given_from_corrected(const StoredView& view, int number, const Sequence& sequence) {
  const auto camera = sequence.read_pose(number);
  if (!camera) return camera.error();
  return *camera * view.world_from_camera.inverse();
}

Result<DetectionsOfTrack> collect_detections(const RecognitionResults& results, const std::vector<int>& views,
                                             const Sequence& sequence, const ModelLibrary& library) {
  DetectionsOfTrack tracks;
  for (std::size_t v = 0; v < results.views.size(); ++v) {
    const auto given = given_from_corrected(results.views[v], views[v], sequence);
    if (!given) return given.error();
    for (const StoredDetection& detection : results.views[v].detections) {
      const int object = library.find(detection.object);
      if (object < 0) return Error{"the detections name '" + detection.object + "', which is not in the library"};
      tracks[detection.track].push_back({views[v], object, detection.score, *given * detection.world_from_object});
    }
  }
  return tracks;
}

/// How a track begins: its event "found" or "added"; null if it has none.
const StoredEvent* find_beginning(const std::vector<StoredEvent>& events, int track) {
  const auto found = std::ranges::find_if(
      events, [&](const StoredEvent& e) { return e.track == track && (e.kind == "found" || e.kind == "added"); });
  return found == events.end() ? nullptr : &*found;
}

/// Adds the detections of a second track of an object up to the view that reports its move. The first track may have
/// been detected at the old place meanwhile: the object had left it.
void join_track(const std::vector<PlacedDetection>& second, int moved_view, std::vector<PlacedDetection>& track) {
  std::erase_if(track, [&](const PlacedDetection& d) { return second.front().view <= d.view && d.view < moved_view; });
  track.insert(track.end(), second.begin(), second.end());
  std::ranges::stable_sort(track, {}, &PlacedDetection::view);
}

/// An object that was added elsewhere before its old place was seen free has two tracks up to the view that reports the
/// move. The report supersedes the beginning of the second track, so the detections of that belong to the first one.
Result<void> join_moved_tracks(const RecognitionResults& results, const std::vector<int>& views,
                               const Sequence& sequence, const ModelLibrary& library, DetectionsOfTrack& tracks) {
  for (const StoredEvent& event : results.events) {
    if (event.kind != "moved" || !event.world_from_object_after) continue;
    const auto v = static_cast<std::size_t>(event.view);
    const auto given = given_from_corrected(results.views[v], views[v], sequence);
    if (!given) return given.error();
    const Rigid3 after = *given * *event.world_from_object_after;
    const auto is_start_of_move = [&](const auto& entry) {
      const PlacedDetection& last = entry.second.back();
      const ObjectModel& model = library.objects[static_cast<std::size_t>(last.object)];
      return entry.first != event.track && model.name == event.object && last.view < views[v] &&
             is_same_place(model, last.world_from_object, after, kSamePlace) &&
             find_beginning(results.events, entry.first) == nullptr;
    };
    for (auto track = tracks.begin(); track != tracks.end();) {
      if (!is_start_of_move(*track)) {
        ++track;
        continue;
      }
      join_track(track->second, views[v], tracks[event.track]);
      track = tracks.erase(track);
    }
  }
  return {};
}

/// The placements of one track: a new one begins where the pose differs from that of the last one, and after a removal.
std::vector<AnnotatedObject> find_placements(const std::vector<PlacedDetection>& detections,
                                             const std::vector<int>& removals, int track, const ModelLibrary& library) {
  std::vector<AnnotatedObject> placements;
  double best_score = 0;
  for (const PlacedDetection& d : detections) {
    const auto removal =
        placements.empty() ? removals.end() : std::ranges::upper_bound(removals, placements.back().last_view);
    const bool was_removed = removal != removals.end() && *removal <= d.view;
    const bool is_new = placements.empty() || was_removed || placements.back().object != d.object ||
                        !is_same_place(library.objects[static_cast<std::size_t>(d.object)],
                                       placements.back().world_from_object, d.world_from_object, kSamePlace);
    if (is_new) {
      if (!placements.empty()) placements.back().last_view = (was_removed ? *removal : d.view) - 1;
      placements.push_back({.id = -1,
                            .track = track,
                            .object = d.object,
                            .first_view = d.view,
                            .last_view = d.view,
                            .world_from_object = d.world_from_object});
      best_score = d.score;
    }
    placements.back().last_view = d.view;
    if (d.score <= best_score) continue;
    best_score = d.score;
    placements.back().world_from_object = d.world_from_object;
  }
  return placements;
}

/// The views in which a track had events of a kind.
std::vector<int> list_views_of(std::string_view kind, int track, const std::vector<StoredEvent>& events,
                               const std::vector<int>& views) {
  std::vector<int> found;
  for (const StoredEvent& event : events)
    if (event.track == track && event.kind == kind) found.push_back(views[static_cast<std::size_t>(event.view)]);
  return found;
}

/// Extends a track to what its events say of its beginning and end.
void extend_track(const std::vector<StoredEvent>& events, const std::vector<int>& moves,
                  const std::vector<int>& removals, int track, int num_views,
                  std::vector<AnnotatedObject>& placements) {
  for (const int view : moves) {
    for (std::size_t i = 0; i + 1 < placements.size(); ++i)
      if (placements[i].last_view >= view && placements[i + 1].first_view > view && placements[i].first_view < view)
        placements[i].last_view = view - 1;
  }
  const StoredEvent* beginning = find_beginning(events, track);
  if (beginning != nullptr && beginning->kind == "found") placements.front().first_view = 0;
  AnnotatedObject& last = placements.back();
  const auto removal = std::ranges::upper_bound(removals, last.last_view);
  last.last_view = (removal == removals.end() ? num_views : *removal) - 1;
}

}  // namespace

Result<AnnotationEdit> detections_to_edit(const RecognitionResults& results, const Sequence& sequence,
                                          const ModelLibrary& library) {
  const auto views = number_views(results, sequence);
  if (!views) return views.error();
  if (const auto same = check_cameras(results, *views, sequence); !same) return same.error();
  auto tracks = collect_detections(results, *views, sequence, library);
  if (!tracks) return tracks.error();
  if (const auto joined = join_moved_tracks(results, *views, sequence, library, *tracks); !joined)
    return joined.error();
  AnnotationEdit edit{.title = "Start from detections", .changes = {}};
  int next_track = 0;
  for (const auto& [track, detections] : *tracks) {
    const bool is_confirmed =
        std::ranges::any_of(results.events, [id = track](const auto& e) { return e.track == id; });
    if (!is_confirmed) continue;
    const std::vector<int> moves = list_views_of("moved", track, results.events, *views);
    const std::vector<int> removals = list_views_of("removed", track, results.events, *views);
    auto placements = find_placements(detections, removals, next_track++, library);
    extend_track(results.events, moves, removals, track, sequence.num_views(), placements);
    for (const AnnotatedObject& placement : placements) edit.changes.emplace_back(PutObject{placement});
  }
  return edit;
}

}  // namespace resight
