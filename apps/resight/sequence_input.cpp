// SPDX-License-Identifier: Apache-2.0
#include "sequence_input.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "commands.hpp"
#include "number_validator.hpp"
#include "resight/core/files.hpp"
#include "resight/inspection/quick_check.hpp"
#include "resight/sensor/disparity_error.hpp"

namespace resight::app {
namespace {

const std::map<std::string, PoseConvention> kConventions = {{"camera-to-world", PoseConvention::kCameraToWorld},
                                                            {"world-to-camera", PoseConvention::kWorldToCamera},
                                                            {"opengl", PoseConvention::kOpenGl}};

std::vector<std::string> sensor_names() {
  std::vector<std::string> names;
  for (const DepthSensor& sensor : depth_sensors()) names.emplace_back(sensor.name);
  return names;
}

const std::string kSequenceGroup = "Sequence";
const std::string kRecordingGroup = "Recording (ROS 1 bag, MCAP, ROS 2 bag)";

std::vector<std::string> list_given(const CLI::App& command) {
  std::vector<std::string> given;
  for (const CLI::Option* option : command.get_options())
    if (option->count() > 0 && (option->get_group() == kSequenceGroup || option->get_group() == kRecordingGroup))
      given.insert(given.end(), {option->get_name(), option->results().back()});
  return given;
}

CLI::Validator finite_seconds() {
  return number_validator([](double) { return true; }, "a number of seconds", "SECONDS");
}

void add_recording_options(CLI::App* command, RecordingTopics& topics) {
  const std::string& group = kRecordingGroup;
  command->add_option("--color-topic", topics.color, "Topic of the colour images")->group(group);
  command->add_option("--depth-topic", topics.depth, "Topic of the depth images")->group(group);
  command->add_option("--camera-info", topics.camera_info, "Topic of the CameraInfo of the colour camera")
      ->group(group);
  command->add_option("--world-frame", topics.world_frame, "Frame of the poses")->group(group);
  command->add_option("--camera-frame", topics.camera_frame, "Frame of the colour camera [that of its images]")
      ->group(group);
  command
      ->add_option_function<double>(
          "--max-time-difference-ms", [&topics](double value) { topics.max_time_difference_s = 1e-3 * value; },
          "Between a colour image and its depth image [20]")
      ->check(number_up_to(1e4))
      ->group(group);
}

}  // namespace

void print_notes(const Sequence& sequence, const std::string& name) {
  const std::string where = name.empty() ? "" : name + ": ";
  for (const std::string& note : sequence.notes()) print_error_line("note: ", where + note);
}

void warn_about(const std::vector<Finding>& findings, const std::string& name) {
  const std::string where = name.empty() ? "" : name + ": ";
  for (const Finding& f : findings) print_warning(where + f.message + "; remedy: " + f.remedy);
}

void warn_about_faults(const Sequence& sequence, bool uses_poses, const std::string& name) {
  warn_about(check_quickly(sequence, uses_poses), name);
}

void add_sequence_options(CLI::App* command, OpenSequenceOptions& options, std::vector<std::string>* given) {
  const std::string& group = kSequenceGroup;
  if (given != nullptr) command->parse_complete_callback([=] { *given = list_given(*command); });
  command
      ->add_option("--intrinsics", options.intrinsics,
                   "fx,fy,cx,cy (px; distortion coefficients after it), or a file with them")
      ->group(group);
  command
      ->add_option("--depth-intrinsics", options.depth_intrinsics,
                   "The same of the depth camera, if folders hold depth that is not registered to colour")
      ->group(group);
  command
      ->add_option("--color-from-depth", options.color_from_depth,
                   "File with the pose of that camera: a matrix of 12 or 16 numbers that maps its points to those of "
                   "the colour camera, metres")
      ->group(group);
  command->add_option("--depth-scale", options.depth_scale_m, "Metres per unit of stored depth, such as 0.001")
      ->check(number_validator([](double value) { return value > 1e-7 && value <= 1; },
                               "a number of metres per unit, such as 0.001 (millimetres) or 0.0002 (5000 per metre)",
                               "METRES"))
      ->group(group);
  command
      ->add_option("--depth-bias", options.depth_bias_per_m,
                   "Bias of the depth that is corrected, 1/m: 1 / z = 1 / measured - bias; 'resight check' measures it "
                   "where the camera moves [0]")
      ->check(number_validator([](double value) { return std::abs(value) <= kMaxDepthBias_per_m; },
                               "a number from -0.05 to 0.05", "1/M"))
      ->group(group);
  command
      ->add_option_function<std::string>(
          "--pose-convention", [&options](const std::string& name) { options.pose_convention = kConventions.at(name); },
          "Poses in files: camera-to-world, world-to-camera, or opengl (camera to world, y up) [camera-to-world]")
      ->check(CLI::IsMember(kConventions))
      ->group(group);
  command
      ->add_option_function<std::string>(
          "--sensor", [&options](const std::string& name) { options.sensor = find_depth_sensor(name); },
          "Kind of depth camera, whose noise is assumed: structured-light (Kinect v1, Xtion), active-stereo (RealSense "
          "D435), active-stereo-d415, time-of-flight (Azure Kinect) [by the names in a recording, else "
          "structured-light]")
      ->check(CLI::IsMember(sensor_names()))
      ->group(group);
  command->add_option("--every", options.views.every, "Takes every n-th view [1]")
      ->check(CLI::Range(1, 1000000))
      ->group(group);
  command
      ->add_option("--min-motion", options.views.min_motion_m,
                   "Takes a view only if the camera, or what is 1 m in front of it, has moved by this since the last "
                   "one, metres [0]")
      ->check(number_up_to(100))
      ->group(group);
  command
      ->add_option("--from", options.views.from_s,
                   "Takes views from this time on, seconds since the first (needs times)")
      ->check(finite_seconds())
      ->group(group);
  command
      ->add_option("--until", options.views.to_s, "Takes views up to this time, seconds since the first (needs times)")
      ->check(finite_seconds())
      ->group(group);
  command->add_option("--max-views", options.views.max_views, "Takes only the first n of these views")
      ->check(CLI::Range(1, 1000000))
      ->group(group);
  add_recording_options(command, options.topics);
}

void add_pose_file_option(CLI::App* command, OpenSequenceOptions& options) {
  command->add_option("--poses", options.poses, "File of camera poses, or fixed: the camera does not move")
      ->group(kSequenceGroup);
}

OpenSequenceOptions parse_sequence_options(std::vector<std::string> given) {
  OpenSequenceOptions options;
  CLI::App app;
  add_sequence_options(&app, options);
  add_pose_file_option(&app, options);
  std::ranges::reverse(given);  // CLI11 takes them from the back.
  try {
    app.parse(std::move(given));
  } catch (const CLI::ParseError& error) {
    throw InputError(std::string("options of the sequence in the results: ") + error.what());
  }
  return options;
}

std::unique_ptr<Sequence> open_input(const std::filesystem::path& where, const OpenSequenceOptions& options) {
  auto sequence = value_or_throw(open_sequence(where, options));
  print_notes(*sequence);
  return sequence;
}

std::unique_ptr<Sequence> open_posed_input(const std::filesystem::path& where, const OpenSequenceOptions& options) {
  auto sequence = value_or_throw(open_posed_sequence(where, options));
  print_notes(*sequence);
  return sequence;
}

TrueChangeFiles find_true_changes(const std::filesystem::path& where, OpenSequenceOptions options,
                                  const Sequence& sequence) {
  const auto folder = value_or_throw(find_sequence_folder(where));
  if (!folder) return {};  // A recording.
  const ViewChoice& choice = options.views;
  const bool may_lack_views = choice.every != 1 || choice.min_motion_m != 0 || choice.from_s || choice.to_s ||
                              choice.max_views || !options.poses.empty();
  options.views = {};
  if (!options.poses.empty()) options.poses = "fixed";  // A file leaves views without a pose out.
  const auto opened = may_lack_views ? value_or_throw(open_sequence(where, options)) : nullptr;
  const Sequence& whole = opened ? *opened : sequence;
  return {find_change_files(*folder, view_names(whole)), whole.num_views() != sequence.num_views()};
}

std::optional<std::vector<ModelLocation>> find_models_to_show(const std::filesystem::path& where) {
  auto models = find_models({where});
  if (models.ok()) return *std::move(models);
  if (!models.error().message.starts_with(file_error(where, "").message)) throw InputError(models.error().message);
  return std::nullopt;
}

}  // namespace resight::app
