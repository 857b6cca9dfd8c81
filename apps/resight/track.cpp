// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <map>
#include <numbers>

#include "camera_run.hpp"
#include "commands.hpp"
#include "fused_cloud.hpp"
#include "output_paths.hpp"
#include "resight/cameras/trajectory_error.hpp"
#include "resight/core/files.hpp"
#include "resight/core/input_file.hpp"
#include "resight/io/convert.hpp"
#include "resight/io/trajectory.hpp"
#include "resight/models/library_file.hpp"
#include "resight/training/training.hpp"
#include "sequence_input.hpp"

namespace resight::app {
namespace {

constexpr double kDegPerRad = 180 / std::numbers::pi;
// How the files begin that this command writes, and may therefore replace.
constexpr const char* kPosesComment = "# world_from_camera of ";
constexpr const char* kPngSignature = "\x89PNG";
constexpr const char* kObjectsComment = "# static objects in ";

std::vector<TrajectoryPose> poses_of(const CameraTrack& track, int component) {
  std::vector<TrajectoryPose> poses;
  for (const TrackedView& view : track.views)
    if (view.component == component) poses.push_back({view.name, view.world_from_camera});
  return poses;
}

// poses.txt, poses_component1.txt, ...
std::filesystem::path file_of_component(const std::filesystem::path& out, int component) {
  if (component == 0) return out;
  return out.parent_path() / fmt::format("{}_component{}{}", out.stem().string(), component, out.extension().string());
}

// Existing files of further components by number. Takes every number: an earlier run may have had more components, and
// a user may have removed some files.
std::map<int, std::filesystem::path> find_component_files(const std::filesystem::path& out) {
  namespace fs = std::filesystem;
  const std::string begin = out.stem().string() + "_component";
  std::map<int, std::filesystem::path> files;
  std::error_code error;
  for (fs::directory_iterator it(out.has_parent_path() ? out.parent_path() : fs::path("."), error), end;
       !error && it != end; it.increment(error)) {
    const std::string name = it->path().filename().string();
    int component = 0;
    if (name.starts_with(begin)) std::from_chars(name.data() + begin.size(), name.data() + name.size(), component);
    if (component > 0 && name == file_of_component(out, component).filename().string())
      files.emplace(component, file_of_component(out, component));
  }
  return files;
}

// poses_objects.txt
std::filesystem::path file_of_objects(const std::filesystem::path& out) {
  return out.parent_path() / (out.stem().string() + "_objects" + out.extension().string());
}

// poses.txt.partial
std::filesystem::path file_of_journal(const std::filesystem::path& out) { return out.string() + ".partial"; }

// All files and folders that a run may write.
Paths list_outputs(const TrackArguments& arguments, int num_views) {
  Paths outputs;
  for (int component = 0; component < std::max(1, num_views); ++component)
    outputs.push_back(file_of_component(arguments.out, component));
  outputs.push_back(file_of_journal(arguments.out));
  if (arguments.models) outputs.push_back(file_of_objects(arguments.out));
  if (arguments.fused) outputs.insert(outputs.end(), {*arguments.fused, picture_of_cloud(*arguments.fused)});
  if (arguments.posed) outputs.push_back(*arguments.posed);
  return outputs;
}

void remove_if_ours(const std::filesystem::path& file, std::string_view signature) {
  const auto start = read_file_start(file, signature.size());
  std::error_code ignored;
  if (start.ok() && *start == signature) std::filesystem::remove(file, ignored);
}

// Removes what an earlier run has left that would pass for a result of this one.
void remove_stale_files(const TrackArguments& arguments, int num_components) {
  for (const auto& [component, file] : find_component_files(arguments.out))
    if (component >= num_components) remove_if_ours(file, kPosesComment);
  if (!arguments.models) remove_if_ours(file_of_objects(arguments.out), kObjectsComment);
}

void write_components(const TrackArguments& arguments, const CameraTrack& track) {
  for (int component = 0; component < track.num_components; ++component) {
    const std::vector<TrajectoryPose> poses = poses_of(track, component);
    std::string comment = fmt::format("{}{} of {} views of {}", kPosesComment + 2, poses.size(), track.views.size(),
                                      arguments.sequence.string());
    if (track.num_components > 1)
      comment += fmt::format("; component {} of {}, each in its own frame", component, track.num_components);
    value_or_throw(write_tum_trajectory(file_of_component(arguments.out, component), poses, comment));
  }
}

void write_objects(const TrackArguments& arguments, const CameraTrack& track, std::span<const StaticObject> objects,
                   const ModelLibrary& library) {
  std::string text =
      fmt::format("{}{}, adjusted jointly with the cameras\n", kObjectsComment, arguments.sequence.string());
  text +=
      "# component tx ty tz qx qy qz qw num_views first_view last_view object (world_from_object, frame of the "
      "component)\n";
  const auto stamp_of = [&](int view) { return to_pose_stamp(track.views[static_cast<std::size_t>(view)].name); };
  for (const StaticObject& object : objects)
    text += fmt::format("{} {} {} {} {} {}\n", object.component, format_tum_pose(object.world_from_object),
                        object.views.size(), stamp_of(object.views.front()), stamp_of(object.views.back()),
                        library.objects[static_cast<std::size_t>(object.object)].name);
  const std::filesystem::path file = file_of_objects(arguments.out);
  value_or_throw(write_file(file, text));
  print("{} static objects: {}\n", objects.size(), file.string());
}

void print_error(const Sequence& recorded, const CameraTrack& track) {
  std::vector<Rigid3> given, found;
  for (std::size_t v = 0; v < track.views.size(); ++v) {
    if (track.views[v].component != 0) continue;
    given.push_back(value_or_throw(recorded.read_pose(static_cast<int>(v))));
    found.push_back(track.views[v].world_from_camera);
  }
  const TrajectoryError error = find_trajectory_error(given, found);
  print("compared with given poses: ATE {:.2f} mm rms, {:.2f} mm max; {:.3f} deg mean, {:.3f} deg max\n",
        1000 * error.rms_m, 1000 * error.max_m, kDegPerRad * error.mean_rad, kDegPerRad * error.max_rad);
}

// Intrinsics may be numbers in place of a file.
Paths list_inputs(const TrackArguments& arguments) {
  Paths inputs{arguments.sequence};
  if (arguments.models) inputs.push_back(*arguments.models);
  if (!is_estimated(arguments.poses)) inputs.emplace_back(arguments.poses);
  const OpenSequenceOptions& input = arguments.input;
  for (const std::string& file : {input.intrinsics, input.depth_intrinsics, input.color_from_depth})
    if (!file.empty()) inputs.emplace_back(file);
  return inputs;
}

// Poses of a run before may be replaced, those of further components included.
void check_outputs(const TrackArguments& arguments) {
  const Paths inputs = list_inputs(arguments);
  const auto check = [&](const std::filesystem::path& file, const char* signature) {
    check_output_file(file, signature, "file of 'resight track'", inputs);
  };
  check(arguments.out, kPosesComment);
  for (const auto& [component, file] : find_component_files(arguments.out)) check(file, kPosesComment);
  if (arguments.models) check(file_of_objects(arguments.out), kObjectsComment);
  if (arguments.posed) check_new_folder(*arguments.posed);
  if (!arguments.fused) return;
  if (arguments.fused->extension() != ".ply")
    throw InputError(file_error(*arguments.fused, "is not the name of a point cloud (.ply was expected)").message);
  const bool is_again = std::filesystem::exists(*arguments.fused);  // The picture belongs to the cloud.
  check_output_file(*arguments.fused, kFusedSignature, "point cloud of 'resight track'", inputs);
  const std::filesystem::path picture = picture_of_cloud(*arguments.fused);
  if (is_again) check_output_file(picture, kPngSignature, "picture", inputs);
  if (!is_again) check_new_file(picture);
}

void write_outputs(const TrackArguments& arguments, const Sequence& sequence, const JointAdjustment& found,
                   const std::optional<ModelLibrary>& library) {
  const CameraTrack& track = found.track;
  write_components(arguments, track);
  if (library) write_objects(arguments, track, found.objects, *library);
  remove_stale_files(arguments, track.num_components);
  const PosedSequence posed = take_largest_component(sequence, track);
  print("{} of {} views joined, {} edges, {} of them between views far apart in the sequence: {}\n", posed.num_views(),
        sequence.num_views(), track.edges.size(), track.num_long_edges, arguments.out.string());
  if (sequence.has_poses()) print_error(sequence, track);
  if (arguments.fused) {
    write_fused_cloud(posed, *arguments.fused, arguments.num_threads);
    print("point cloud: {}\n", arguments.fused->string());
  }
  if (!arguments.posed) return;
  value_or_throw(convert_sequence(posed, *arguments.posed, to_format(arguments.format)));
  print("sequence with these poses: {}\n", arguments.posed->string());
}

}  // namespace

void run_track(const TrackArguments& arguments) {
  check_outputs(arguments);
  const bool refine = arguments.poses != "auto";
  const auto sequence = open_input(arguments.sequence, with_poses(arguments.input, arguments.poses));
  check_apart(list_outputs(arguments, sequence->num_views()));
  if (arguments.posed) value_or_throw(check_view_names(*sequence, *arguments.posed, to_format(arguments.format)));
  warn_about_faults(*sequence, refine);
  std::optional<ModelLibrary> library;
  if (arguments.models) library = value_or_throw(load_library(*arguments.models, TrainOptions{}.hash()));
  std::optional<TrackJournal> journal;
  if (!refine) journal = open_track_journal(file_of_journal(arguments.out), *sequence, arguments.sequence);
  const JointAdjustment found = track_sequence(*sequence, arguments.sequence,
                                               {.refine = refine,
                                                .library = library ? &*library : nullptr,
                                                .journal = journal ? &*journal : nullptr,
                                                .adjust_objects = library.has_value(),
                                                .num_threads = arguments.num_threads});
  check_outputs(arguments);  // Again: another program may have written them meanwhile.
  write_outputs(arguments, *sequence, found, library);
  if (journal) journal->remove();  // Last: whatever ends the program before, what was tracked is not lost.
}

}  // namespace resight::app
