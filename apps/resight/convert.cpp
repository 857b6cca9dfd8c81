// SPDX-License-Identifier: Apache-2.0
#include "resight/io/convert.hpp"

#include <fmt/format.h>

#include "commands.hpp"
#include "progress.hpp"
#include "resight/io/model_source.hpp"
#include "resight/io/sequence.hpp"
#include "resight/io/tuw_models.hpp"
#include "resight/models/surface.hpp"
#include "resight/simulation/turntable.hpp"

namespace resight::app {
namespace {

constexpr double kSurfaceVoxel_m = 0.002;  // of 3D_model.pcd
constexpr double kSamplesPerSquareMetre = 4 / (kSurfaceVoxel_m * kSurfaceVoxel_m);

DatasetFormat to_format(const std::string& name) { return name == "bop" ? DatasetFormat::kBop : DatasetFormat::kTuw; }

// A TUW model is made of views: a mesh is put on a virtual turntable.
void render_tuw_models(const std::vector<ModelLocation>& models, const ConvertArguments& arguments) {
  Progress progress("convert", static_cast<int>(models.size()));
  for (std::size_t m = 0; m < models.size(); ++m) {
    const ModelSource source = value_or_throw(read_model(models[m]));
    if (source.mesh) {
      TurntableOptions options;
      options.num_threads = arguments.num_threads;
      const PointCloud surface =
          voxel_downsample(sample_surface(*source.mesh, kSamplesPerSquareMetre), kSurfaceVoxel_m);
      value_or_throw(write_tuw_model(arguments.out, source.name, render_turntable(*source.mesh, options), &surface,
                                     source.symmetries, source.bop_id));
    } else {
      value_or_throw(convert_models(std::span(&models[m], 1), arguments.out, DatasetFormat::kTuw));
    }
    progress.report(static_cast<int>(m) + 1, source.name);
  }
}

}  // namespace

void run_convert(const ConvertArguments& arguments) {
  const DatasetFormat format = to_format(arguments.format);
  if (std::filesystem::exists(arguments.out))
    throw InputError(fmt::format("{}: exists already (a new folder was expected)", arguments.out.string()));
  const auto sequence = open_sequence(arguments.in);
  const auto models = find_models({arguments.in});
  if (!sequence.ok() && !models.ok())
    throw InputError(fmt::format("{}; {}", sequence.error().message, models.error().message));
  if (sequence.ok()) {
    const ConversionSummary summary = value_or_throw(convert_sequence(**sequence, arguments.out, format));
    fmt::print("{} views, {} annotated objects: {}\n", summary.num_views, summary.num_objects, arguments.out.string());
  } else if (format == DatasetFormat::kTuw) {
    render_tuw_models(*models, arguments);
    fmt::print("{} models: {}\n", models->size(), arguments.out.string());
  } else {
    const ConversionSummary summary = value_or_throw(convert_models(*models, arguments.out, format));
    fmt::print("{} models: {}\n", summary.num_objects, arguments.out.string());
  }
}

}  // namespace resight::app
