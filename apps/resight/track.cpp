// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <charconv>

#include "camera_run.hpp"
#include "commands.hpp"
#include "fused_cloud.hpp"
#include "output_paths.hpp"
#include "resight/cameras/trajectory_error.hpp"
#include "resight/core/files.hpp"
#include "resight/io/convert.hpp"
#include "resight/io/trajectory.hpp"
#include "resight/models/library_file.hpp"
#include "resight/training/training.hpp"
#include "sequence_input.hpp"

namespace resight::app {
namespace {

constexpr double kDegPerRad = 57.29577951308232;
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

// Takes every number: an earlier run may have had more components, and a user may have removed some files.
Paths list_component_files(const std::filesystem::path& out) {
  namespace fs = std::filesystem;
  const std::string begin = out.stem().string() + "_component";
  Paths files;
  std::error_code error;
  for (fs::directory_iterator it(out.has_parent_path() ? out.parent_path() : fs::path("."), error), end;
       !error && it != end; it.increment(error)) {
    const std::string name = it->path().filename().string();
    int component = 0;
    if (name.starts_with(begin)) std::from_chars(name.data() + begin.size(), name.data() + name.size(), component);
    if (component > 0 && name == file_of_component(out, component).filename().string())
      files.push_back(file_of_component(out, component));
  }
  std::ranges::sort(files);
  return files;
}

// poses_objects.txt
std::filesystem::path file_of_objects(const std::filesystem::path& out) {
  return out.parent_path() / (out.stem().string() + "_objects" + out.extension().string());
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
  for (const StaticObject& object : objects)
    text += fmt::format("{} {} {} {} {} {}\n", object.component, format_tum_pose(object.world_from_object),
                        object.views.size(), track.views[static_cast<std::size_t>(object.views.front())].name,
                        track.views[static_cast<std::size_t>(object.views.back())].name,
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
  for (const std::filesystem::path& file : list_component_files(arguments.out)) check(file, kPosesComment);
  if (arguments.models) check(file_of_objects(arguments.out), kObjectsComment);
  if (arguments.posed) {
    check_new_folder(*arguments.posed);
    for (const std::filesystem::path& file : {arguments.out, arguments.fused.value_or(arguments.out)})
      if (is_within(file, *arguments.posed))
        throw InputError(file_error(file, "lies in the folder of --write-sequence, which must be new").message);
  }
  if (!arguments.fused) return;
  if (arguments.fused->extension() != ".ply")
    throw InputError(file_error(*arguments.fused, "is not the name of a point cloud (.ply was expected)").message);
  const bool is_again = std::filesystem::exists(*arguments.fused);  // The picture belongs to the cloud.
  check_output_file(*arguments.fused, kFusedSignature, "point cloud of 'resight track'", inputs);
  const std::filesystem::path picture = picture_of_cloud(*arguments.fused);
  if (is_again) check_output_file(picture, kPngSignature, "picture", inputs);
  if (!is_again) check_new_file(picture);
}

}  // namespace

void run_track(const TrackArguments& arguments) {
  check_outputs(arguments);
  const bool refine = arguments.poses != "auto";
  const auto sequence = open_input(arguments.sequence, with_poses(arguments.input, arguments.poses));
  warn_about_faults(*sequence, refine);
  std::optional<ModelLibrary> library;
  if (arguments.models) library = value_or_throw(load_library(*arguments.models, TrainOptions{}.hash()));
  const auto [track, objects] = track_sequence(*sequence, {.refine = refine,
                                                           .library = library ? &*library : nullptr,
                                                           .journal = arguments.out.string() + ".partial",
                                                           .sequence_folder = arguments.sequence,
                                                           .adjust_objects = library.has_value(),
                                                           .num_threads = arguments.num_threads});
  write_components(arguments, track);
  if (library) write_objects(arguments, track, objects, *library);
  const PosedSequence posed = take_largest_component(*sequence, track);
  print("{} of {} views joined, {} edges, {} loops: {}\n", posed.num_views(), sequence->num_views(), track.edges.size(),
        track.num_loops, arguments.out.string());
  if (sequence->has_poses()) print_error(*sequence, track);
  if (arguments.fused) {
    write_fused_cloud(posed, *arguments.fused, arguments.num_threads);
    print("point cloud: {}\n", arguments.fused->string());
  }
  if (!arguments.posed) return;
  const DatasetFormat format = arguments.format == "bop" ? DatasetFormat::kBop : DatasetFormat::kTuw;
  value_or_throw(convert_sequence(posed, *arguments.posed, format));
  print("sequence with these poses: {}\n", arguments.posed->string());
}

}  // namespace resight::app
