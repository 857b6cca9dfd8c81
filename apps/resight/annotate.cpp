// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>

#include "commands.hpp"
#include "folder_files.hpp"
#include "interrupts.hpp"
#include "output_paths.hpp"
#include "progress.hpp"
#include "recognition_run.hpp"
#include "resight/annotation/annotated_inputs.hpp"
#include "resight/annotation/change_proposals.hpp"
#include "resight/annotation/detections_to_edit.hpp"
#include "resight/annotation/export_annotation.hpp"
#include "resight/annotation/proposals_file.hpp"
#include "resight/core/files.hpp"
#include "resight/io/recognition_results.hpp"
#include "resight/models/library_file.hpp"
#include "resight/recognition/stage_options.hpp"
#include "resight/viewer/annotation_service.hpp"
#include "sequence_input.hpp"
#include "viewer_session.hpp"

namespace resight::app {
namespace {

namespace fs = std::filesystem;

constexpr int kMinRegionPoints = 30;  // Of 5 mm: about 3 cm across.

/// What the proposals depend on beside the views that are read. The number of threads is not part of it.
std::string describe_inputs(const fs::path& input, const fs::path& project, const RecognizerConfig& config) {
  std::string text = fmt::format("resight {}, regions of {} points\n", RESIGHT_VERSION, kMinRegionPoints);
  text += describe_files(input, project);
  for (const auto& [name, value] : config.to_settings()) text += fmt::format("{} = {}\n", name, value);
  return text;
}

/// The regions that the change detector proposes. They are kept in the project while views and detector stay the same.
std::vector<ChangeProposal> find_regions(const Sequence& sequence, const fs::path& input,
                                         const AnnotateArguments& arguments) {
  const RecognizerConfig config = make_config("default", std::nullopt, std::nullopt, arguments.num_threads);
  const fs::path file = arguments.out / "proposals.json";
  const std::string digest = value_or_throw(digest_inputs(sequence, describe_inputs(input, arguments.out, config)));
  if (auto known = read_proposals(file, digest, sequence.num_views())) return *std::move(known);
  Progress progress("annotate", sequence.num_views());
  auto regions = value_or_throw(propose_changes(sequence, scene_options(config), kMinRegionPoints, [&](int view) {
    progress.report(view + 1, sequence.view_name(view) + ": changes");
  }));
  value_or_throw(write_proposals(file, digest, regions));
  return regions;
}

Result<AnnotationEdit> read_detections(const fs::path& detections, const Sequence& sequence,
                                       const ModelLibrary& library) {
  if (!fs::exists(detections)) return file_error(detections, "no such file or directory");
  const fs::path folder = fs::is_directory(detections) ? detections : detections.parent_path();
  const auto results = read_recognition_results(folder.empty() ? "." : folder);
  if (!results) return results.error();
  return detections_to_edit(*results, sequence, library);
}

/// A new project starts with what was recognised. A project that has begun stays as it is.
void add_detections(Result<AnnotationEdit> detected, AnnotationProject& project) {
  if (project.revision() > 0) {
    print_warning("the project has begun already; the detections are not added again");
    return;
  }
  AnnotationEdit edit = value_or_throw(std::move(detected));
  if (edit.changes.empty()) return;
  const ActionOutcome outcome = project.act(std::move(edit), 0);
  if (outcome.kind != ActionOutcome::Kind::kApplied) throw InputError(outcome.message);
}

}  // namespace

void run_annotate(const AnnotateArguments& arguments) {
  check_output_folder(arguments.out, "annotate", {arguments.sequence});
  const fs::path export_folder = arguments.out / "export";
  value_or_throw(check_export_folder(export_folder));  // Before the work, not after it.
  const std::shared_ptr<const Sequence> sequence = open_posed_input(arguments.sequence, arguments.input);
  warn_about_faults(*sequence, true);
  const auto library = std::make_shared<const ModelLibrary>(value_or_throw(load_library(arguments.models)));
  const fs::path input = value_or_throw(find_sequence_folder(arguments.sequence)).value_or(arguments.sequence);
  const std::string name = folder_name(input);
  AnnotationTask task{.sequence = sequence,
                      .library = library,
                      .regions = {},
                      .project = nullptr,
                      .scene_name = name,
                      .export_folder = export_folder};
  // All that may be wrong, before a project is made and the regions are found, which takes minutes.
  const AnnotatedInputs inputs = value_or_throw(identify_inputs(*sequence, *library));
  std::optional<Result<AnnotationEdit>> detected;
  if (arguments.detections) {
    detected = read_detections(*arguments.detections, *sequence, *library);
    if (!*detected && !AnnotationProject::is_in(arguments.out)) throw InputError(detected->error().message);
  }
  ViewerSession session({.port = arguments.port, .no_open = arguments.no_open});
  const AnnotationLimits limits{.num_views = sequence->num_views(),
                                .num_objects = static_cast<int>(library->objects.size())};
  task.project = value_or_throw(AnnotationProject::open(arguments.out, limits, inputs.digest, inputs.earlier_digest));
  if (task.project->was_cut_off()) print_warning("the last action was cut off and is dropped");
  if (detected) add_detections(*std::move(detected), *task.project);
  task.regions = find_regions(*sequence, input, arguments);
  AnnotationService service(std::move(task));

  ViewerScene shown;
  shown.title = name;
  shown.sequence = sequence;
  shown.library = library;
  shown.is_annotated = true;
  const auto scene = value_or_throw(SceneData::create(std::move(shown)));
  session.show(*scene, &service);
  session.open_until_interrupted();
  clean_up_when_interrupted();
  value_or_throw(service.save());
  print("{}\n", export_folder.string());
}

}  // namespace resight::app
