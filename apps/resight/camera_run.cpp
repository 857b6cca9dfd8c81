// SPDX-License-Identifier: Apache-2.0
#include "camera_run.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "commands.hpp"
#include "progress.hpp"
#include "resight/cameras/common_objects.hpp"
#include "resight/core/files.hpp"
#include "resight/core/hash.hpp"
#include "resight/recognition/observe_objects.hpp"
#include "sequence_input.hpp"

namespace resight::app {
namespace {

std::string describe(const TrackedView& view) {
  std::string text = fmt::format("{}: component {}, overlap {:.2f}", view.name, view.component, view.overlap);
  if (view.num_matches >= 0) text += fmt::format(", {} matches", view.num_matches);
  return text;
}

std::vector<ObservedObject> observe_with_progress(const Sequence& sequence, const ModelLibrary& library,
                                                  int num_threads) {
  Progress progress("objects", sequence.num_views());
  return value_or_throw(observe_objects(sequence, library, num_threads, [&](int view, const SceneUpdate& update) {
    progress.report(view + 1, fmt::format("{}: {} objects", update.view_name, update.detections.size()));
  }));
}

PreparedView read_prepared(const Sequence& sequence, int view, int num_threads) {
  PrepareViewOptions options;
  options.max_pixels = kMaxWorkingPixels;
  options.num_threads = num_threads;
  return prepare_view(value_or_throw(sequence.read_view(view)), options);
}

// What the first view holds: other intrinsics, another unit of depth, sensor or topic are another job.
std::uint64_t hash_first_view(const Sequence& sequence) {
  if (sequence.num_views() == 0) return kHashSeed;
  const RgbdFrame frame = value_or_throw(sequence.read_view(0));
  const Camera& camera = frame.camera;
  const DepthNoise& noise = camera.noise;
  std::uint64_t hash =
      hash_text(fmt::format("{}x{} {} {} {} {} noise {} {} {} {} {} {}", camera.width, camera.height, camera.fx,
                            camera.fy, camera.cx, camera.cy, noise.constant_m, noise.quadratic_per_m, noise.nearest_m,
                            noise.grazing, noise.lateral_px, noise.lateral_grazing_px));
  const auto add = [&](const auto& pixels) {
    hash = checksum_bytes({reinterpret_cast<const std::uint8_t*>(pixels.data()), pixels.size_bytes()}, hash);
  };
  add(std::span(frame.depth_m.data()));
  add(std::span(frame.color.data()));
  return hash;
}

std::string describe_job(const Sequence& sequence, const std::filesystem::path& folder) {
  std::string names;
  for (int v = 0; v < sequence.num_views(); ++v) names += sequence.view_name(v) + "\n";
  return fmt::format("resight {}, {}: {} views, names {:016x}, first view {:016x}", RESIGHT_VERSION,
                     std::filesystem::absolute(folder).lexically_normal().string(), sequence.num_views(),
                     hash_text(names), hash_first_view(sequence));
}

// Restores the views that an interrupted run tracked; returns their number.
int restore(ViewTracker& tracker, const Sequence& sequence, const TrackJournal& journal, Progress& progress) {
  int view = 0;
  for (const TrackerStep& step : journal.steps()) {
    if (view == sequence.num_views()) break;  // Only a journal that was edited has more.
    std::optional<PreparedView> prepared;
    if (step.view.is_keyframe) prepared = read_prepared(sequence, view, 1);
    tracker.restore_view(step, prepared ? &*prepared : nullptr);
    progress.report(++view, step.view.name + ": tracked before");
  }
  return view;
}

CameraTrack track_views(const Sequence& sequence, const TrackSequenceOptions& options) {
  if (options.refine && !sequence.has_poses())
    throw InputError("the sequence has no camera poses to refine (try --poses auto)");
  TrackViewsOptions track;
  track.num_threads = options.num_threads;
  ViewTracker tracker(track);
  Progress progress("track", sequence.num_views());
  const int first = options.journal != nullptr ? restore(tracker, sequence, *options.journal, progress) : 0;
  for (int v = first; v < sequence.num_views(); ++v) {
    const PreparedView view = read_prepared(sequence, v, options.num_threads);
    if (options.refine) tracker.add_posed_view(view);
    progress.report(v + 1, options.refine ? view.frame.name : describe(tracker.add_view(view)));
    if (options.journal != nullptr) value_or_throw(options.journal->append(tracker.last_step()));
  }
  return tracker.finish();
}

// Surfaces of up to eight evenly spaced views per component: enough to detect contradictions between components.
std::vector<AlignmentView> read_surfaces(const Sequence& sequence, const CameraTrack& track) {
  constexpr std::size_t kViewsOfPart = 8;
  std::vector<std::vector<int>> of_component(static_cast<std::size_t>(track.num_components));
  for (std::size_t v = 0; v < track.views.size(); ++v)
    of_component[static_cast<std::size_t>(track.views[v].component)].push_back(static_cast<int>(v));
  std::vector<AlignmentView> surfaces(track.views.size());
  for (const std::vector<int>& views : of_component)
    for (std::size_t k = 0; k < std::min(views.size(), kViewsOfPart); ++k) {
      const int v = views[k * views.size() / std::min(views.size(), kViewsOfPart)];
      surfaces[static_cast<std::size_t>(v)] = make_alignment_view(read_prepared(sequence, v, 1));
    }
  return surfaces;
}

void warn_of_components(const CameraTrack& track) {
  std::string left_out;
  for (const TrackedView& view : track.views)
    if (view.component != 0) left_out += fmt::format(" {} (component {})", view.name, view.component);
  if (!left_out.empty())
    print_warning("these views could not be joined to the others and have no pose in their frame:" + left_out);
}

}  // namespace

TrackJournal open_track_journal(const std::filesystem::path& file, const Sequence& sequence,
                                const std::filesystem::path& folder) {
  return value_or_throw(TrackJournal::open(file, describe_job(sequence, folder)));
}

JointAdjustment track_sequence(const Sequence& sequence, const std::filesystem::path& folder,
                               const TrackSequenceOptions& options) {
  CameraTrack track = track_views(sequence, options);
  std::vector<ObservedObject> observed;
  const bool join = options.library != nullptr && track.num_components > 1;
  if (join || options.adjust_objects) observed = observe_with_progress(sequence, *options.library, options.num_threads);
  if (join) {
    const auto surfaces = read_surfaces(sequence, track);
    track = join_by_objects(std::move(track), observed, *options.library, surfaces);
  }
  if (track.num_components > 1 && track.num_components == sequence.num_views()) {
    if (options.journal != nullptr) options.journal->remove();
    throw InputError(file_error(folder,
                                "no two views could be joined: the relative poses of their cameras are unknown "
                                "(are depth scale and intrinsics right?)")
                         .message);
  }
  warn_of_components(track);
  if (!options.adjust_objects) return {std::move(track), {}};
  return adjust_jointly(std::move(track), observed, *options.library);
}

PosedSequence take_largest_component(const Sequence& sequence, const CameraTrack& track) {
  std::vector<int> views;
  std::vector<Rigid3> poses;
  for (std::size_t v = 0; v < track.views.size(); ++v) {
    if (track.views[v].component != 0) continue;
    views.push_back(static_cast<int>(v));
    poses.push_back(track.views[v].world_from_camera);
  }
  return {sequence, std::move(views), std::move(poses)};
}

bool is_estimated(const std::string& poses) { return poses == "auto" || poses == "refine"; }

OpenSequenceOptions with_poses(OpenSequenceOptions options, const std::string& poses) {
  if (poses != "given" && !is_estimated(poses)) options.poses = poses;
  return options;
}

std::unique_ptr<Sequence> open_recorded_input(const std::filesystem::path& where, const OpenSequenceOptions& options,
                                              const std::string& poses) {
  const OpenSequenceOptions input = with_poses(options, poses);
  auto recorded = is_estimated(poses) ? open_input(where, input) : open_posed_input(where, input);
  warn_about_faults(*recorded, poses != "auto");
  return recorded;
}

std::optional<PosedSequence> estimate_poses(const Sequence& recorded, const std::filesystem::path& folder,
                                            const std::string& poses, const ModelLibrary* library, int num_threads) {
  if (!is_estimated(poses)) return std::nullopt;
  TrackSequenceOptions options;
  options.refine = poses == "refine";
  options.library = library;
  options.num_threads = num_threads;
  return take_largest_component(recorded, track_sequence(recorded, folder, options).track);
}

}  // namespace resight::app
