// SPDX-License-Identifier: Apache-2.0
#include "resight/io/convert.hpp"

#include <fmt/format.h>

#include "commands.hpp"
#include "output_paths.hpp"
#include "progress.hpp"
#include "resight/core/files.hpp"
#include "resight/evaluation/change_truth.hpp"
#include "resight/geometry/mesh_sampling.hpp"
#include "resight/io/model_source.hpp"
#include "resight/io/sequence.hpp"
#include "resight/io/tuw_models.hpp"
#include "resight/rendering/turntable.hpp"
#include "resight/training/training.hpp"
#include "sequence_input.hpp"

namespace resight::app {
namespace {

constexpr double kSurfaceVoxel_m = 0.002;  // Of 3D_model.pcd.
constexpr double kSamplesPerSquareMetre = 4 / (kSurfaceVoxel_m * kSurfaceVoxel_m);

// Reads every model once before the work, so that a mistake in the last one is found at once.
void check_models(const std::vector<ModelLocation>& models, DatasetFormat format) {
  for (const ModelLocation& location : models) {
    const ModelSource source = value_or_throw(read_model(location));
    if (format == DatasetFormat::kTuw && !source.mesh && source.views.empty())
      throw InputError(file_error(location.path, "is a cloud without views, of which a TUW model consists").message);
    if (source.views.empty()) continue;
    if (const auto checked = check_training_input(source.name, source.views); !checked)
      throw InputError(file_error(location.path, checked.error().message).message);
  }
}

// A TUW model consists of views, so a mesh is rendered on a virtual turntable.
std::vector<std::string> render_tuw_models(const std::vector<ModelLocation>& models,
                                           const ConvertArguments& arguments) {
  auto folder = value_or_throw(PendingDirectory::create(arguments.out));
  std::vector<std::string> warnings;
  Progress progress("convert", static_cast<int>(models.size()));
  for (std::size_t m = 0; m < models.size(); ++m) {
    const ModelSource source = value_or_throw(read_model(models[m]));
    if (source.mesh) {
      TurntableOptions options;
      options.num_threads = arguments.num_threads;
      const PointCloud surface =
          voxel_downsample(sample_surface(*source.mesh, kSamplesPerSquareMetre), kSurfaceVoxel_m);
      value_or_throw(write_tuw_model(folder.path(), source.name, render_turntable(*source.mesh, options), &surface,
                                     source.symmetries, source.bop_id, source.symmetries_known));
    } else {
      value_or_throw(write_tuw_model(folder.path(), source.name, source.views,
                                     source.surface ? &*source.surface : nullptr, source.symmetries, source.bop_id,
                                     source.symmetries_known));
    }
    warnings.insert(warnings.end(), source.warnings.begin(), source.warnings.end());
    progress.report(static_cast<int>(m) + 1, source.name);
  }
  value_or_throw(folder.commit());
  return warnings;
}

// The files of the true changes of a sequence, or none for a part of its views.
ChangeFiles find_changes(const ConvertArguments& arguments, const Sequence& sequence) {
  const TrueChangeFiles found = find_true_changes(arguments.in, arguments.input, sequence);
  if (found.sequence_lacks_views) {
    if (!found.files.empty()) print_warning("the true changes are left out, because not all views are converted");
    return {};
  }
  if (!found.files.events.empty()) value_or_throw(read_true_changes(found.files.events, sequence.num_views()));
  return found.files;
}

}  // namespace

void run_convert(const ConvertArguments& arguments) {
  const DatasetFormat format = to_format(arguments.format);
  check_new_folder(arguments.out);
  if (!std::filesystem::exists(arguments.in))
    throw InputError(fmt::format("{}: no such file or folder", arguments.in.string()));
  const auto sequence = open_sequence(arguments.in, arguments.input);
  // A damaged sequence, or several, are not passed over for the models beside them.
  if (!sequence.ok() && value_or_throw(find_sequence_folder(arguments.in))) throw InputError(sequence.error().message);
  const auto models = find_models({arguments.in});
  if (!sequence.ok() && !models.ok())
    throw InputError(fmt::format("{}; {}", sequence.error().message, models.error().message));
  if (sequence.ok()) {
    print_notes(**sequence);
    const ConversionSummary summary =
        value_or_throw(convert_sequence(**sequence, arguments.out, format, find_changes(arguments, **sequence)));
    print("{} views, {} annotated objects: {}\n", summary.num_views, summary.num_objects, arguments.out.string());
    return;
  }
  check_models(*models, format);
  if (format == DatasetFormat::kTuw) {
    for (const std::string& warning : render_tuw_models(*models, arguments)) print_warning(warning);
    print("{} models: {}\n", models->size(), arguments.out.string());
  } else {
    const ConversionSummary summary = value_or_throw(convert_models(*models, arguments.out, format));
    for (const std::string& warning : summary.warnings) print_warning(warning);
    print("{} models: {}\n", summary.num_objects, arguments.out.string());
  }
}

}  // namespace resight::app
