// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <stdexcept>

#include "commands.hpp"
#include "progress.hpp"
#include "resight/core/files.hpp"
#include "resight/io/sequence.hpp"
#include "resight/modelling/track_object.hpp"
#include "resight/modelling/write_model.hpp"

namespace resight::app {
namespace {

// The recording could be read, but no model comes of it: not a mistake of the command line.
template <typename T>
T value_or_fail(Result<T> result) {
  if (!result.ok()) throw std::runtime_error(result.error().message);
  return std::move(result).value();
}

std::vector<RgbdFrame> read_frames(const std::filesystem::path& folder) {
  const std::unique_ptr<Sequence> sequence = value_or_throw(open_sequence(folder));
  if (sequence->num_views() < 2)
    throw InputError(file_error(folder, "has one view only (a recording of several was expected)").message);
  std::vector<RgbdFrame> frames;
  for (int view = 0; view < sequence->num_views(); ++view) frames.push_back(value_or_throw(sequence->read_view(view)));
  return frames;
}

void print_track(const std::filesystem::path& folder, const ObjectTrack& track) {
  fmt::print("{}: {} views, {}", folder.string(), track.views.size(),
             track.is_camera_still ? "turntable" : "moving camera");
  if (!track.loops.empty())
    fmt::print(", closes with {:.1f} mm (followed: {:.1f} mm)\n", 1000 * track.closure_error_m, 1000 * track.drift_m);
  else
    fmt::print(", does not close\n");
}

}  // namespace

void run_model(const ModelArguments& arguments) {
  if (std::filesystem::exists(arguments.out) &&
      (!std::filesystem::is_directory(arguments.out) || !std::filesystem::is_empty(arguments.out)))
    throw InputError(file_error(arguments.out, "exists already and is not empty").message);
  value_or_throw(check_writable(arguments.out));
  TrackObjectOptions track_options;
  track_options.num_threads = arguments.num_threads;
  BuildModelOptions build_options;
  build_options.num_threads = arguments.num_threads;

  ObjectTrack whole;
  {
    Progress progress("model", static_cast<int>(arguments.sequences.size()));
    for (std::size_t i = 0; i < arguments.sequences.size(); ++i) {
      const std::filesystem::path& folder = arguments.sequences[i];
      Result<ObjectTrack> track = track_object(read_frames(folder), track_options);
      if (!track) throw std::runtime_error(file_error(folder, track.error().message).message);
      print_track(folder, *track);
      whole =
          i == 0 ? std::move(*track) : value_or_fail(join_tracks(std::move(whole), std::move(*track), track_options));
      progress.report(static_cast<int>(i) + 1, folder_name(folder));
    }
  }
  ObjectModelBuild build = value_or_fail(build_model(whole.views, build_options));
  build.report.closure_error_m = whole.closure_error_m;
  value_or_throw(write_object_model(arguments.out, whole.views, build));
  fmt::print("{}model {}: {}\n", format_report(build.report), folder_name(arguments.out), arguments.out.string());
}

}  // namespace resight::app
