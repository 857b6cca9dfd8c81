// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>

#include "commands.hpp"
#include "output_paths.hpp"
#include "progress.hpp"
#include "resight/core/files.hpp"
#include "resight/io/model_source.hpp"
#include "resight/io/sequence.hpp"
#include "resight/modelling/track_object.hpp"
#include "resight/modelling/write_model.hpp"
#include "resight/sensor/prepared_view.hpp"
#include "resight/sensor/reduce_frame.hpp"
#include "sequence_input.hpp"

namespace resight::app {
namespace {

// All views are kept in memory, and those of similar directions are aligned pair by pair.
constexpr int kMaxModelViews = 150;
constexpr int kMinKnownColumns = 80;  // At half resolution, narrower views of an existing model have nothing to align.

// Recordings that yield no model are wrong input, too: the line names them.
template <typename T>
T value_of(const std::filesystem::path& recording, Result<T> result) {
  if (!result.ok()) throw InputError(file_error(recording, result.error().message).message);
  return std::move(result).value();
}

std::unique_ptr<Sequence> open_object_views(const std::filesystem::path& folder, const OpenSequenceOptions& input) {
  std::unique_ptr<Sequence> sequence = open_input(folder, input);
  if (sequence->num_views() < 2)
    throw InputError(file_error(folder, "has only one view (several were expected)").message);
  return sequence;
}

std::vector<RgbdFrame> read_frames(const std::filesystem::path& folder, const OpenSequenceOptions& input) {
  const std::unique_ptr<Sequence> sequence = open_object_views(folder, input);
  const int step = (sequence->num_views() + kMaxModelViews - 1) / kMaxModelViews;
  if (step > 1) print("{}: {} views, takes one of {}\n", folder.string(), sequence->num_views(), step);
  std::vector<RgbdFrame> frames;
  for (int view = 0; view < sequence->num_views(); view += step)
    frames.push_back(value_or_throw(read_reduced_view(*sequence, view, kMaxWorkingPixels)));
  return frames;
}

void print_track(const std::filesystem::path& folder, const ObjectTrack& track) {
  print("{}: {} views, {}", folder.string(), track.views.size(), track.is_camera_still ? "turntable" : "moving camera");
  if (!track.loops.empty())
    print(", loop closure error {:.1f} mm (before adjustment: {:.1f} mm)\n", 1000 * track.closure_error_m,
          1000 * track.drift_m);
  else
    print(", no loop closure\n");
}

ObjectTrack follow(const std::filesystem::path& folder, const OpenSequenceOptions& input,
                   const TrackObjectOptions& options) {
  std::vector<RgbdFrame> frames = read_frames(folder, input);
  Result<ObjectTrack> track = [&] {
    Progress progress("model " + folder_name(folder), static_cast<int>(frames.size()));
    return track_object(std::move(frames), options,
                        [&](int done, const std::string& view) { progress.report(done, view); });
  }();
  ObjectTrack followed = value_of(folder, std::move(track));
  print_track(folder, followed);
  return followed;
}

// Of an existing model: its key views, and what it declares.
struct KnownModel {
  ObjectTrack track;
  DeclaredModelInfo declared;
};

KnownModel read_known_model(const std::filesystem::path& folder) {
  const std::vector<ModelLocation> found = value_or_throw(find_models({folder}));
  ModelSource source = value_or_throw(read_model(found.front()));
  if (found.size() > 1 || source.views.empty())
    throw InputError(
        file_error(folder,
                   "does not contain exactly one model with views (a folder written by 'resight model' was expected)")
            .message);
  KnownModel model{{},
                   {.symmetries = std::move(source.symmetries),
                    .bop_id = source.bop_id,
                    .symmetries_known = source.symmetries_known}};
  std::erase_if(source.views, [](const TrainingView& view) {
    return std::ranges::all_of(view.mask.data(), [](std::uint8_t is_object) { return is_object == 0; });
  });
  if (source.views.empty()) throw InputError(file_error(folder, "has no view whose mask shows the object").message);
  for (const TrainingView& view : source.views)
    if (const int columns = view.frame.camera.width; columns < kMinKnownColumns)
      throw InputError(file_error(folder, fmt::format("view {}: is {} columns wide (expected {} or more)",
                                                      view.frame.name, columns, kMinKnownColumns))
                           .message);
  model.track.views = std::move(source.views);
  return model;
}

}  // namespace

void run_model(const ModelArguments& arguments) {
  check_new_folder(arguments.out);
  TrackObjectOptions track_options;
  track_options.num_threads = arguments.num_threads;
  BuildModelOptions build_options;
  build_options.num_threads = arguments.num_threads;

  if (arguments.sequences.size() > 1)  // Before the first one takes its time.
    for (const std::filesystem::path& folder : arguments.sequences)
      static_cast<void>(open_object_views(folder, arguments.input));
  std::optional<ObjectTrack> whole;
  DeclaredModelInfo declared;
  if (arguments.onto) {
    KnownModel known = read_known_model(*arguments.onto);
    whole = std::move(known.track);
    declared = std::move(known.declared);
  }
  for (const std::filesystem::path& folder : arguments.sequences) {
    ObjectTrack track = follow(folder, arguments.input, track_options);
    whole =
        whole ? value_of(folder, join_tracks(std::move(*whole), std::move(track), track_options)) : std::move(track);
  }
  std::string recordings;
  for (const std::filesystem::path& folder : arguments.sequences)
    recordings += (recordings.empty() ? "" : ", ") + folder.string();
  ObjectModelBuild build = value_of(recordings, build_model(whole->views, build_options));
  build.report.closure_error_m = whole->closure_error_m;
  value_or_throw(write_object_model(arguments.out, whole->views, build, declared));
  print_text(format_report(build.report));
  print("model {}: {}\n", folder_name(arguments.out), arguments.out.string());
}

}  // namespace resight::app
