// SPDX-License-Identifier: Apache-2.0
#include "camera_run.hpp"

#include <fmt/format.h>

#include <utility>

#include "commands.hpp"
#include "progress.hpp"
#include "resight/cameras/common_objects.hpp"
#include "resight/recognition/scene_recognizer.hpp"

namespace resight::app {
namespace {

std::string describe(const TrackedView& view) {
  std::string text = fmt::format("{}: part {}, overlap {:.2f}", view.name, view.part, view.overlap);
  if (view.num_matches >= 0) text += fmt::format(", {} matches", view.num_matches);
  return text;
}

// What each view shows by itself.
std::vector<ObservedObject> observe_objects(const Sequence& sequence, const ModelLibrary& library, int num_threads) {
  RecognizerConfig config = RecognizerConfig::from_preset("default");
  config.num_previous_views = 0;
  config.set_num_threads(num_threads);
  SceneRecognizer recognizer(library, config);
  std::vector<ObservedObject> observed;
  Progress progress("common objects", sequence.num_views());
  for (int v = 0; v < sequence.num_views(); ++v) {
    const SceneUpdate update = recognizer.add_view(value_or_throw(sequence.read_view(v)));
    const Rigid3 camera_from_world = update.world_from_camera.inverse();
    for (const Detection& d : update.detections)
      observed.push_back({v, d.object, camera_from_world * d.world_from_object});
    progress.report(v + 1, fmt::format("{}: {} objects", update.view_name, update.detections.size()));
  }
  return observed;
}

void warn_of_parts(const CameraTrack& track) {
  std::string left_out;
  for (const TrackedView& view : track.views)
    if (view.part != 0) left_out += fmt::format(" {} (part {})", view.name, view.part);
  if (!left_out.empty())
    print_warning("could not be joined to the other views, and have no pose among them:" + left_out);
}

}  // namespace

CameraTrack track_sequence(const Sequence& sequence, bool refine, const ModelLibrary* library, int num_threads) {
  if (refine && !sequence.has_poses()) throw InputError("the sequence holds no camera poses to refine (try auto)");
  TrackViewsOptions options;
  options.num_threads = num_threads;
  ViewTracker tracker(options);
  PrepareViewOptions prepare;
  prepare.num_threads = num_threads;
  Progress progress("track", sequence.num_views());
  for (int v = 0; v < sequence.num_views(); ++v) {
    const PreparedView view = prepare_view(value_or_throw(sequence.read_view(v)), prepare);
    if (refine) tracker.add_posed_view(view);
    progress.report(v + 1, refine ? view.frame.name : describe(tracker.add_view(view)));
  }
  CameraTrack track = tracker.finish();
  if (track.num_parts > 1 && library != nullptr)
    track = join_by_objects(std::move(track), observe_objects(sequence, *library, num_threads), *library);
  if (track.num_parts > 1 && track.num_parts == sequence.num_views())
    throw std::runtime_error("no two views could be joined: nothing tells how their cameras stood to each other");
  warn_of_parts(track);
  return track;
}

PosedSequence take_largest_part(const Sequence& sequence, const CameraTrack& track) {
  std::vector<int> views;
  std::vector<Rigid3> poses;
  for (std::size_t v = 0; v < track.views.size(); ++v) {
    if (track.views[v].part != 0) continue;
    views.push_back(static_cast<int>(v));
    poses.push_back(track.views[v].world_from_camera);
  }
  return {sequence, std::move(views), std::move(poses)};
}

}  // namespace resight::app
