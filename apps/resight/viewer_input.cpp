// SPDX-License-Identifier: Apache-2.0
#include "viewer_input.hpp"

#include "resight/core/files.hpp"
#include "resight/core/input_file.hpp"
#include "resight/core/unfinished_folder.hpp"
#include "resight/io/recognition_results.hpp"
#include "resight/models/library_file.hpp"
#include "sequence_input.hpp"

namespace resight::app {
namespace {

namespace fs = std::filesystem;

bool is_library(const fs::path& path) {
  std::error_code error;
  if (!fs::is_regular_file(path, error)) return false;
  const auto start = read_file_start(path, kLibrarySignature.size());
  return start.ok() && *start == kLibrarySignature;
}

std::shared_ptr<const ModelLibrary> open_library(const fs::path& path) {
  return std::make_shared<const ModelLibrary>(value_or_throw(load_library(path)));
}

/// The sequence that results are of: the one of the arguments, else the one that the results name.
fs::path sequence_of_results(const ViewArguments& arguments, const ViewerRun& run) {
  if (arguments.sequence) return *arguments.sequence;
  if (run.results.sequence.empty())
    throw InputError(run.name + ": the results do not name their sequence (pass --sequence)");
  return run.results.sequence;
}

/// Without a library, objects have neither surfaces nor outlines; that is no reason to show nothing.
void add_library(const ViewArguments& arguments, ViewerScene& scene) {
  if (arguments.models) {
    scene.library = open_library(*arguments.models);
    return;
  }
  if (scene.runs.empty() || scene.runs.front().results.models.empty()) return;
  auto library = load_library(scene.runs.front().results.models);
  if (library.ok())
    scene.library = std::make_shared<const ModelLibrary>(*std::move(library));
  else
    print_warning(library.error().message + "; objects are shown without their surfaces (pass --models)");
}

/// Name of the folder of results; with its parent if another run has the same name.
std::string name_run(const fs::path& folder, const std::vector<ViewerRun>& others) {
  const std::string name = folder_name(folder);
  for (const ViewerRun& other : others)
    if (other.name == name) return folder.string();
  return name;
}

ViewerScene open_results(const ViewArguments& arguments) {
  ViewerScene scene;
  for (const fs::path& folder : arguments.inputs) {
    if (!has_recognition_results(folder))
      throw InputError(folder.string() + ": holds no results of 'resight recognize' to compare with the others");
    scene.runs.push_back({name_run(folder, scene.runs), value_or_throw(read_recognition_results(folder))});
  }
  const fs::path sequence = sequence_of_results(arguments, scene.runs.front());
  scene.title = folder_name(sequence);
  const bool as_recorded = arguments.given_input.empty() && !arguments.sequence;
  const OpenSequenceOptions input =
      as_recorded ? parse_sequence_options(scene.runs.front().results.sequence_options) : arguments.input;
  scene.sequence = open_input(sequence, input);
  add_library(arguments, scene);
  return scene;
}

ViewerScene open_sequence(const fs::path& sequence, const OpenSequenceOptions& input,
                          const std::optional<fs::path>& models) {
  ViewerScene scene;
  scene.title = folder_name(sequence);
  scene.sequence = open_input(sequence, input);
  if (models) scene.library = open_library(*models);
  return scene;
}

/// Every path is shown or refused.
ViewerScene open_sequence_or_models(const ViewArguments& arguments, const fs::path& input) {
  if (is_library(input)) {
    if (arguments.models) throw InputError(file_error(input, "is a model library, and so is --models").message);
    if (arguments.sequence) return open_sequence(*arguments.sequence, arguments.input, input);
    ViewerScene scene;
    scene.title = folder_name(input);
    scene.library = open_library(input);
    return scene;
  }
  if (value_or_throw(find_sequence_folder(input))) {
    if (arguments.sequence) throw InputError(file_error(input, "is a sequence, and so is --sequence").message);
    return open_sequence(input, arguments.input, arguments.models);
  }
  auto models = find_models_to_show(input);
  if (!models)
    throw InputError(file_error(input,
                                "is nothing to view (expected results of 'resight recognize', a sequence, a model "
                                "library or models)")
                         .message);
  if (arguments.sequence || arguments.models)
    throw InputError(file_error(input, "holds models, which are shown without --sequence and --models").message);
  ViewerScene scene;
  scene.title = folder_name(input);
  scene.models = *std::move(models);
  return scene;
}

ViewerScene open_views_or_models(const ViewArguments& arguments) {
  const fs::path& input = arguments.inputs.front();
  std::error_code error;
  if (!fs::exists(input, error)) throw InputError(file_error(input, "no such file or directory").message);
  value_or_throw(check_finished(input));
  if (has_recognition_results(input)) return open_results(arguments);
  if (arguments.inputs.size() > 1)
    throw InputError(input.string() + ": holds no results of 'resight recognize' to compare with the others");
  if (fs::exists(input / "changes.json", error))
    throw InputError(
        file_error(input, "holds results of 'resight changes' (give the sequence, and this by --changes)").message);
  return open_sequence_or_models(arguments, input);
}

/// Checked by the first view, so that a wrong folder is noticed at once.
void add_changes(const fs::path& folder, ViewerScene& scene) {
  if (!scene.sequence) throw InputError(file_error(folder, "needs the sequence that it is of (pass it, too)").message);
  value_or_throw(check_finished(folder));
  const fs::path first = folder / (scene.sequence->view_name(0) + ".ply");
  std::error_code error;
  if (!fs::is_regular_file(first, error))
    throw InputError(file_error(folder, "holds no results of 'resight changes' on these views").message);
  scene.changes = folder;
}

}  // namespace

ViewerScene open_viewer_scene(const ViewArguments& arguments) {
  ViewerScene scene = open_views_or_models(arguments);
  if (arguments.changes) add_changes(*arguments.changes, scene);
  return scene;
}

}  // namespace resight::app
