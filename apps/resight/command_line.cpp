// SPDX-License-Identifier: Apache-2.0
#include "command_line.hpp"

#include <CLI/CLI.hpp>
#include <charconv>
#include <map>

#include "evaluation_plan.hpp"
#include "number_validator.hpp"
#include "resight/core/parallel.hpp"
#include "resight/recognition/options_reference.hpp"
#include "sequence_input.hpp"

namespace resight::app {
namespace {

const CLI::Validator kFormats = CLI::IsMember({"tuw", "bop"});
const std::map<std::string, double> kMeshUnits = {{"m", 1}, {"cm", 0.01}, {"mm", 0.001}, {"in", 0.0254}};
const CLI::Validator kPresets = CLI::IsMember({"mvr", "mvr-chd", "default"});

// CLI11 accepts -1 and 99999999999999999999 as unsigned numbers.
const CLI::Validator kSeeds(
    [](const std::string& text) {
      std::uint64_t seed = 0;
      const auto [end, code] = std::from_chars(text.data(), text.data() + text.size(), seed);
      const bool is_seed = code == std::errc() && end == text.data() + text.size();
      return is_seed ? std::string() : text + " is not a whole number from 0 to 2^64 - 1";
    },
    "NUMBER >= 0");

void add_threads(CLI::App* command, int& num_threads) {
  num_threads = num_hardware_threads();
  command->add_option("-j,--threads", num_threads, "Number of threads; results do not depend on it")
      ->check(CLI::Range(1, 1024))
      ->capture_default_str();
}

template <typename Recognition>
void add_recognition_options(CLI::App* command, Recognition& arguments) {
  command
      ->add_option("-k,--previous-views", arguments.num_previous_views,
                   "Number of previous views that are used with the current one [default: 5]")
      ->check(CLI::Range(0, 1000));
  command
      ->add_option("--preset", arguments.preset,
                   "mvr (static world), mvr-chd (the paper's system) or default (recommended)")
      ->check(kPresets)
      ->capture_default_str();
  command->add_option("--config", arguments.config,
                      "TOML file that overrides individual settings (keys: 'resight options')");
  add_threads(command, arguments.num_threads);
}

std::function<void()> add_train(CLI::App& app, TrainArguments& a) {
  CLI::App* command = app.add_subcommand("train", "Train a model library from scanned views or meshes");
  command->add_option("inputs", a.inputs, "TUW model folder, BOP models folder, folder of meshes, or mesh files")
      ->required();
  command->add_option("--out", a.out, "Model library to write")->required();
  command
      ->add_option_function<std::string>(
          "--mesh-unit", [&a](const std::string& unit) { a.metres_per_unit = kMeshUnits.at(unit); },
          "Unit of the meshes and clouds [default: mm in a BOP models folder, else m]")
      ->check(CLI::IsMember(kMeshUnits));
  add_threads(command, a.num_threads);
  return [&a] { run_train(a); };
}

const CLI::Validator kCameras(
    [](const std::string& text) {
      return text == "openni2" || text.starts_with("openni2:") ? std::string()
                                                               : text + " is not openni2 or openni2:URI";
    },
    "openni2[:URI]");

void add_live_options(CLI::App* command, RecognizeArguments& a) {
  const std::string group = "Live";
  CLI::Option* follow =
      command
          ->add_flag("--follow", a.follow.is_on,
                     "Take the views of the folder as they are written into it, until Ctrl-C; results are written then")
          ->excludes("--view")
          ->group(group);
  command
      ->add_option(
          "--camera", a.camera,
          "Instead of --sequence: a camera of OpenNI2 that does not move (openni2, or openni2:URI), until Ctrl-C, or a "
          "recording of one (openni2:FILE.oni), played once")
      ->check(kCameras)
      ->excludes("--view")
      ->excludes("--sequence")
      ->excludes(follow)
      ->group(group);
  command
      ->add_option("--idle-timeout-s", a.follow.idle_timeout_s,
                   "With --follow or --camera: also end when no view has come for this many seconds")
      ->check(positive_number())
      ->group(group);
  command
      ->add_flag(
          "--keep-late", a.follow.keeps_late,
          "With --follow: take every view, in order. Otherwise only the newest one is taken when several wait, and "
          "the others are counted")
      ->group(group);
}

void add_poses(CLI::App* command, std::string& poses) {
  command
      ->add_option("--poses", poses,
                   "Camera poses: given, refine (starting from the given poses), auto (from the views alone), fixed "
                   "(the camera does not move), or a file")
      ->check(CLI::IsMember({"given", "refine", "auto", "fixed"}) | CLI::ExistingFile)
      ->capture_default_str();
}

std::function<void()> add_recognize(CLI::App& app, RecognizeArguments& a) {
  CLI::App* command =
      app.add_subcommand("recognize", "Recognise trained objects in a sequence of views and report what changed");
  command->add_option("--models", a.models, "Model library (made by 'resight train')")->required();
  command->add_option("--sequence", a.sequence, "Sequence folder or recording (detected)");
  command->add_option("--out", a.out, "Folder for the results")->required();
  add_poses(command, a.poses);
  command
      ->add_option("--seed", a.seed, "Seed of all random choices; the same seed gives the same results [run.seed: 1]")
      ->check(kSeeds);
  command
      ->add_option("--deadline-ms", a.deadline_ms,
                   "Time limit per view; a view returns its best result so far, which depends on the machine [default: "
                   "no limit]")
      ->check(positive_number());
  command->add_flag("--trace", a.trace,
                    "Write what became of each hypothesis, and where missed objects were lost (trace.jsonl), too");
  command->add_flag("--view", a.view,
                    "Show the views in a browser as they are recognised; afterwards, Ctrl-C ends the program");
  command
      ->add_flag("--stream", a.stream,
                 "Print each view as one line of JSON on standard output as it is recognised, and nothing else there")
      ->excludes("--view");
  add_live_options(command, a);
  add_recognition_options(command, a);
  add_sequence_options(command, a.input, &a.given_input);
  return [&a] { run_recognize(a); };
}

std::function<void()> add_changes(CLI::App& app, ChangesArguments& a) {
  CLI::App* command = app.add_subcommand("changes", "Detect what was added and removed between views, without models");
  command->add_option("--sequence", a.sequence, "Sequence folder or recording (detected)")->required();
  command->add_option("--out", a.out, "Folder for changes.json, overlays and masks (PNG), and point clouds (PLY)")
      ->required();
  add_recognition_options(command, a);
  add_poses(command, a.poses);
  add_sequence_options(command, a.input);
  return [&a] { run_changes(a); };
}

std::function<void()> add_track(CLI::App& app, TrackArguments& a) {
  CLI::App* command = app.add_subcommand("track", "Estimate or refine the camera poses of a sequence from its views");
  command->add_option("--sequence", a.sequence, "Sequence folder or recording (detected); needs no poses")->required();
  command->add_option("--out", a.out, "Trajectory to write (TUM: stamp tx ty tz qx qy qz qw, metres)")->required();
  command
      ->add_option(
          "--poses", a.poses,
          "auto: from the views alone; refine: starting from the given poses; or a file of poses to start from")
      ->check(CLI::IsMember({"auto", "refine"}) | CLI::ExistingFile)
      ->capture_default_str();
  command->add_option("--models", a.models, "Model library; joins views without overlap by common objects");
  command->add_option("--write-sequence", a.posed,
                      "Folder for a copy of the sequence with these poses; must be empty or not exist");
  command->add_option("--fused", a.fused,
                      "Point cloud of all views to write (PLY), with a picture of it next to it (PNG)");
  command->add_option("--format", a.format, "Format of --write-sequence: tuw or bop")
      ->check(kFormats)
      ->capture_default_str();
  add_threads(command, a.num_threads);
  add_sequence_options(command, a.input);
  return [&a] { run_track(a); };
}

std::function<void()> add_simulate(CLI::App& app, SimulateArguments& a) {
  CLI::App* command =
      app.add_subcommand("simulate", "Render a scripted, changing scene as RGB-D views with ground truth");
  CLI::Option* preset = command->add_option(
      "--preset", a.preset,
      "Built-in scene: demo; tables with random objects: tabletop, crowded (closely packed), twins (similar "
      "objects), plain (untextured); sparse-views (for 'resight track'); "
      "dynamic-tabletop (benchmark of 9 sequences, version 3; dynamic-tabletop-2 "
      "is version 2); dynamic-tabletop-recordings (of half of its objects), "
      "turntable-recording or walk-recording (both sides of one object), for "
      "'resight model'");
  CLI::Option* script = command->add_option("scene", a.script, "Scene script (TOML)");
  preset->excludes(script);
  command->add_option("--object", a.object,
                      "Generated object to record, for the presets *-recording; an unknown name lists all "
                      "[default: milk_carton]");
  command->add_option("--out", a.out, "Data set folder to write")->required();
  command->add_option("--format", a.format, "Format of the data set: tuw or bop")
      ->check(kFormats)
      ->capture_default_str();
  command->add_option("--seed", a.seed, "Seed of the scene and of the sensor noise")
      ->check(kSeeds)
      ->capture_default_str();
  command->add_flag("--noise-free", a.noise_free,
                    "Exact depth and colour instead of simulated errors of the sensor; camera poses keep theirs");
  add_threads(command, a.num_threads);
  return [&a] { run_simulate(a); };
}

std::function<void()> add_model(CLI::App& app, ModelArguments& a) {
  CLI::App* command = app.add_subcommand(
      "model", "Build an object model from recordings on a turntable or with a camera moved around the object");
  command
      ->add_option("--sequence", a.sequences,
                   "Recording once around the object (TUW, BOP, TUM and others, detected); repeat for the object lying "
                   "on another side")
      ->required();
  command->add_option("--onto", a.onto, "Existing model folder to whose views the recordings are added");
  command->add_option("--out", a.out, "Model folder to write (TUW), for 'resight train'; must be empty or not exist")
      ->required();
  add_threads(command, a.num_threads);
  add_sequence_options(command, a.input);
  add_pose_file_option(command, a.input);
  return [&a] { run_model(a); };
}

std::function<void()> add_convert(CLI::App& app, ConvertArguments& a) {
  CLI::App* command = app.add_subcommand("convert", "Convert a data set (sequence or models) to another format");
  command->add_option("in", a.in, "Sequence, recording or models folder")->required();
  command->add_option("out", a.out, "Folder to write; must be empty or not exist")->required();
  command->add_option("--to", a.format, "Format to write: tuw or bop")->required()->check(kFormats);
  add_threads(command, a.num_threads);
  add_sequence_options(command, a.input);
  add_pose_file_option(command, a.input);
  return [&a] { run_convert(a); };
}

std::function<void()> add_info(CLI::App& app, InfoArguments& a) {
  CLI::App* command =
      app.add_subcommand("info", "Describe a sequence, a recording and its topics, models, a library or results");
  command->add_option("path", a.path, "What to describe")->required();
  command->add_flag("--json", a.as_json, "Print JSON");
  add_sequence_options(command, a.input);
  add_pose_file_option(command, a.input);
  return [&a] { run_info(a); };
}

std::function<void()> add_check(CLI::App& app, CheckArguments& a, bool& is_sound) {
  CLI::App* command = app.add_subcommand(
      "check", "Measure faults of a sequence: depth, colours, intrinsics, poses. Exit status 1: there are some");
  command->add_option("sequence", a.sequence, "Sequence folder or recording (detected)")->required();
  command->add_option("--models", a.models,
                      "Model library: also compare the sizes of its objects with those in the views");
  command->add_option("--out", a.out, "Folder for findings.json and a picture of each finding");
  command->add_option("--views", a.max_views, "Largest number of inspected views, spread over the sequence")
      ->check(CLI::Range(3, 1000))
      ->capture_default_str();
  command->add_flag("--json", a.as_json, "Print JSON");
  add_threads(command, a.num_threads);
  add_sequence_options(command, a.input);
  add_pose_file_option(command, a.input);
  return [&a, &is_sound] { is_sound = run_check(a); };
}

std::function<void()> add_evaluate(CLI::App& app, EvaluateArguments& a, std::optional<std::string>& shard) {
  CLI::App* command = app.add_subcommand(
      "evaluate", "Score presets on a data set with ground truth: recognition over K, ghosts, changes, losses, times");
  command->add_option("--models", a.models, "Model library (made by 'resight train')")->required();
  command->add_option("--dataset", a.dataset, "Folder with sequences (in test/ or directly in it), or one sequence")
      ->required();
  command->add_option("--out", a.out, "Folder for the results; runs that it already contains are not computed again")
      ->required();
  command->add_option("--presets", a.presets, "Presets, separated by commas")->capture_default_str();
  command->add_option("-k,--previous-views", a.previous_views,
                      "Numbers of previous views that are used with the current one: numbers and ranges, e.g. 0-2,5 "
                      "[num_previous_views: 5]");
  command->add_option("--config", a.config, "TOML file that overrides individual settings of all presets");
  command->add_flag("--without-clustering", a.without_clustering, "Also evaluate without clustering of hypotheses");
  command->add_flag("--bop", a.bop,
                    "Also compute the average recalls of the BOP benchmark (needs meshes in the data set)");
  command->add_option("--shard", shard,
                      "I/N: compute only the I-th of N parts; the last part to finish merges the results");
  command->add_flag("--merge", a.merge, "Only merge existing runs; fails if one is missing")->excludes("--shard");
  command
      ->add_option("--seed", a.seed, "Seed of all random choices; the same seed gives the same results [run.seed: 1]")
      ->check(kSeeds);
  add_threads(command, a.num_threads);
  return [&a, &shard] {
    if (shard) parse_shard(*shard, a.shard, a.num_shards);
    run_evaluate(a);
  };
}

std::function<void()> add_demo(CLI::App& app, DemoArguments& a) {
  CLI::App* command =
      app.add_subcommand("demo", "Run everything on a built-in scene: simulate, train, recognise, compare, report");
  command->add_option("--out", a.out, "Folder for data, results and report")->capture_default_str();
  command->add_option("--seed", a.seed, "Seed of the scene and of all random choices")
      ->check(kSeeds)
      ->capture_default_str();
  add_threads(command, a.num_threads);
  return [&a] { run_demo(a); };
}

std::function<void()> add_view(CLI::App& app, ViewArguments& a) {
  CLI::App* command = app.add_subcommand("view", "Look at results, a sequence or models in a browser");
  command
      ->add_option("inputs", a.inputs,
                   "Folder of results (of 'resight recognize'), or several to compare; a sequence folder; a model "
                   "library; models")
      ->required();
  command->add_option("--sequence", a.sequence, "Sequence of the results [default: the one that they name]");
  command->add_option("--models", a.models, "Model library of the objects [default: the one that the results name]");
  command->add_option("--changes", a.changes,
                      "Folder of 'resight changes' on the same views: also show its reconstruction and changes");
  add_sequence_options(command, a.input, &a.given_input);
  add_pose_file_option(command, a.input);
  command->add_option("--port", a.port, "Port on 127.0.0.1; 0 takes a free one")->capture_default_str();
  command->add_flag("--no-open", a.no_open, "Print the address only, without opening a browser");
  return [&a] { run_view(a); };
}

std::function<void()> add_annotate(CLI::App& app, AnnotateArguments& a) {
  CLI::App* command = app.add_subcommand("annotate", "Annotate the objects and changes of a sequence in a browser");
  command->add_option("--models", a.models, "Model library (made by 'resight train')")->required();
  command->add_option("--sequence", a.sequence, "Sequence folder or recording, with camera poses")->required();
  add_sequence_options(command, a.input);
  add_pose_file_option(command, a.input);
  command->add_option("--detections", a.detections,
                      "detections.json of 'resight recognize' on the sequence: a new project starts from it");
  command->add_option("--out", a.out, "Project folder; an existing project is continued")->required();
  command->add_option("--port", a.port, "Port on 127.0.0.1; 0 takes a free one")->capture_default_str();
  command->add_flag("--no-open", a.no_open, "Print the address only, without opening a browser");
  add_threads(command, a.num_threads);
  return [&a] { run_annotate(a); };
}

std::function<void()> add_options(CLI::App& app) {
  app.add_subcommand("options", "Print all options of settings files (--config) as Markdown");
  return [] { print_text(options_reference()); };
}

}  // namespace

std::vector<std::function<void()>> add_commands(CLI::App& app, Arguments& a) {
  return {add_demo(app, a.demo),
          add_simulate(app, a.simulate),
          add_train(app, a.train),
          add_recognize(app, a.recognize),
          add_changes(app, a.changes),
          add_track(app, a.track),
          add_model(app, a.model),
          add_convert(app, a.convert),
          add_info(app, a.info),
          add_check(app, a.check, a.is_sound),
          add_evaluate(app, a.evaluate, a.shard),
          add_view(app, a.view),
          add_annotate(app, a.annotate),
          add_options(app)};
}

}  // namespace resight::app
