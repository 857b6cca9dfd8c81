// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <filesystem>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "resight/core/result.hpp"
#include "resight/io/sequence.hpp"
#include "terminal.hpp"

namespace resight::app {

/// Invalid input or command line: one line for the user, exit status 2.
struct InputError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Returns the value, or throws an InputError with its message.
template <typename T>
T value_or_throw(Result<T> result) {
  if (!result.ok()) throw InputError(result.error().message);
  return std::move(result).value();
}
inline void value_or_throw(const Result<void>& result) {
  if (!result.ok()) throw InputError(result.error().message);
}

/// The format of `--format`, whose values the command line has checked.
inline DatasetFormat to_format(const std::string& name) {
  return name == "bop" ? DatasetFormat::kBop : DatasetFormat::kTuw;
}

/// Three decimals, or "-" for NaN.
[[nodiscard]] std::string format_share(double share);

/// The output of a command as its messages name it.
template <typename Arguments>
std::string shown_output(const Arguments& arguments) {
  return (arguments.shown_out.empty() ? arguments.out : arguments.shown_out).string();
}

/// Prints one line to standard error.
void print_warning(const std::string& what);

struct TrainArguments {
  std::vector<std::filesystem::path> inputs;
  std::optional<double> metres_per_unit;  ///< Of meshes and clouds; none: as their layout has it.
  std::filesystem::path out;
  std::filesystem::path shown_out;  ///< What messages name instead of `out`, if it is moved later.
  int num_threads = 1;
};

/// Views that are still being written.
struct FollowArguments {
  bool is_on = false;
  bool keeps_late = false;               ///< Takes every view; otherwise the newest one.
  std::optional<double> idle_timeout_s;  ///< Ends when no view has come for so long; none: only with Ctrl-C.
};

struct RecognizeArguments {
  std::filesystem::path models;
  std::filesystem::path sequence;
  OpenSequenceOptions input;
  std::vector<std::string> given_input;  ///< Those of the options that were given: name and value in turn.
  std::filesystem::path out;
  std::string poses = "given";  ///< given, refine, auto, fixed, or a file.
  std::string preset = "default";
  std::optional<std::filesystem::path> config;
  std::optional<int> num_previous_views;
  std::optional<double> deadline_ms;
  std::optional<std::uint64_t> seed;  ///< Otherwise that of the settings.
  bool view = false;                  ///< Show views in a browser as they are recognised, and the results afterwards.
  bool trace = false;                 ///< Write what became of each hypothesis, too.
  bool stream = false;                ///< Print each view as one line of JSON as it is recognised, and nothing else.
  std::string camera;                 ///< "openni2" or "openni2:URI", instead of a sequence.
  FollowArguments follow;
  int num_threads = 1;
};

struct ChangesArguments {
  std::filesystem::path sequence;
  OpenSequenceOptions input;
  std::filesystem::path out;
  std::string poses = "given";  ///< given, refine, auto, fixed, or a file.
  std::string preset = "default";
  std::optional<std::filesystem::path> config;
  std::optional<int> num_previous_views;
  int num_threads = 1;
};

struct TrackArguments {
  std::filesystem::path sequence;
  OpenSequenceOptions input;
  std::filesystem::path out;
  std::optional<std::filesystem::path> models;  ///< Joins views by common objects.
  std::optional<std::filesystem::path> posed;   ///< Folder for the sequence with its poses.
  std::optional<std::filesystem::path> fused;   ///< Point cloud of all views.
  std::string poses = "auto";                   ///< auto, refine, or a file.
  std::string format = "tuw";                   ///< Format of the posed sequence.
  int num_threads = 1;
};

struct SimulateArguments {
  std::string preset;            ///< Either a preset or a script must be given.
  std::filesystem::path script;  ///< See `preset`.
  /// Object recorded by the presets *-recording; empty = milk_carton.
  std::string object;
  std::filesystem::path out;
  std::filesystem::path shown_out;  ///< What messages name instead of `out`, if it is moved later.
  std::string format = "tuw";
  std::uint64_t seed = 1;
  bool noise_free = false;
  int num_threads = 1;
};

struct ModelArguments {
  std::vector<std::filesystem::path> sequences;
  OpenSequenceOptions input;  ///< Of all of them.
  /// Existing model to which the recordings are added.
  std::optional<std::filesystem::path> onto;
  std::filesystem::path out;
  int num_threads = 1;
};

struct ConvertArguments {
  std::filesystem::path in;
  OpenSequenceOptions input;
  std::filesystem::path out;
  std::string format;
  int num_threads = 1;
};

struct InfoArguments {
  std::filesystem::path path;
  OpenSequenceOptions input;
  bool as_json = false;
};

struct CheckArguments {
  std::filesystem::path sequence;
  OpenSequenceOptions input;
  std::optional<std::filesystem::path> models;  ///< Library whose objects tell the scale.
  std::optional<std::filesystem::path> out;     ///< Folder for the findings with pictures.
  int max_views = 24;
  bool as_json = false;
  int num_threads = 1;
};

struct DemoArguments {
  std::filesystem::path out = "resight-demo";
  std::uint64_t seed = 1;
  int num_threads = 1;
};

struct EvaluateArguments {
  std::filesystem::path models;
  std::filesystem::path dataset;
  std::filesystem::path out;
  std::string presets = "mvr,mvr-chd,default";
  std::optional<std::string> previous_views;  ///< Otherwise that of the settings.
  std::optional<std::filesystem::path> config;
  bool without_clustering = false;  ///< Also run without clustering.
  int shard = 1;
  int num_shards = 1;
  bool merge = false;                 ///< Merge only, without computing.
  bool bop = false;                   ///< Also compute the BOP average recalls.
  std::optional<std::uint64_t> seed;  ///< Otherwise that of the settings.
  int num_threads = 1;
};

struct ViewArguments {
  std::vector<std::filesystem::path> inputs;
  std::optional<std::filesystem::path> sequence;  ///< Otherwise that of the results.
  OpenSequenceOptions input;
  std::vector<std::string> given_input;          ///< If empty, the results tell how their sequence was opened.
  std::optional<std::filesystem::path> models;   ///< Otherwise those of the results.
  std::optional<std::filesystem::path> changes;  ///< Results of `resight changes` on the same views.
  std::uint16_t port = 0;                        ///< 0: a free one.
  bool no_open = false;                          ///< Do not open a browser.
};

struct AnnotateArguments {
  std::filesystem::path models;
  std::filesystem::path sequence;
  OpenSequenceOptions input;
  std::optional<std::filesystem::path> detections;  ///< detections.json of `resight recognize`, or its folder.
  std::filesystem::path out;                        ///< The project.
  std::uint16_t port = 0;                           ///< 0: a free one.
  bool no_open = false;                             ///< Do not open a browser.
  int num_threads = 1;
};

// Each function runs one subcommand. InputError = exit status 2, any other exception = 1.
void run_train(const TrainArguments& arguments);
void run_recognize(const RecognizeArguments& arguments);
void run_changes(const ChangesArguments& arguments);
void run_track(const TrackArguments& arguments);
void run_simulate(const SimulateArguments& arguments);
void run_model(const ModelArguments& arguments);
void run_convert(const ConvertArguments& arguments);
void run_info(const InfoArguments& arguments);
/// Whether the sequence is sound.
[[nodiscard]] bool run_check(const CheckArguments& arguments);
void run_evaluate(const EvaluateArguments& arguments);
void run_view(const ViewArguments& arguments);
void run_annotate(const AnnotateArguments& arguments);
void run_demo(const DemoArguments& arguments);

}  // namespace resight::app
