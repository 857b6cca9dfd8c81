// SPDX-License-Identifier: Apache-2.0
#include "resight/io/convert.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "resight/core/check.hpp"
#include "resight/io/bop_models.hpp"
#include "resight/io/internal/files.hpp"
#include "resight/io/internal/sequences.hpp"
#include "resight/io/tuw_changes.hpp"
#include "resight/io/tuw_models.hpp"

namespace resight {
namespace {

void add_model(const ModelSource& model, ConversionSummary& summary) {
  summary.num_views += static_cast<int>(model.views.size());
  ++summary.num_objects;
  summary.warnings.insert(summary.warnings.end(), model.warnings.begin(), model.warnings.end());
}

Result<ConversionSummary> convert_to_bop(std::span<const ModelLocation> models,
                                         const std::filesystem::path& directory) {
  std::vector<int> wanted;
  for (const ModelLocation& location : models) wanted.push_back(location.bop_id);
  const auto ids = assign_bop_ids(wanted);
  if (!ids) return io::file_error(directory, ids.error().message);
  // `directory` appears with both of its folders, or not at all.
  auto pending = io::PendingDirectory::create(directory);
  if (!pending) return pending.error();
  const auto writer = BopModelsWriter::create(pending->path());
  if (!writer) return writer.error();
  ConversionSummary summary;
  for (std::size_t i = 0; i < models.size(); ++i) {
    const auto model = read_model(models[i]);
    if (!model) return model.error();
    if (const auto done = (*writer)->write_model(*model, (*ids)[i]); !done) return done.error();
    add_model(*model, summary);
  }
  if (const auto done = (*writer)->finish(); !done) return done.error();
  if (const auto done = pending->commit(); !done) return done.error();
  return summary;
}

Result<ConversionSummary> convert_to_tuw(std::span<const ModelLocation> models,
                                         const std::filesystem::path& directory) {
  auto pending = io::PendingDirectory::create(directory);
  if (!pending) return pending.error();
  ConversionSummary summary;
  for (const ModelLocation& location : models) {
    const auto model = read_model(location);
    if (!model) return model.error();
    if (model->views.empty())
      return io::file_error(location.path,
                            "is a mesh without views; a TUW model consists of views, which must be rendered first");
    const auto done =
        write_tuw_model(pending->path(), model->name, model->views, model->surface ? &*model->surface : nullptr,
                        model->symmetries, model->bop_id, model->symmetries_known);
    if (!done) return done.error();
    add_model(*model, summary);
  }
  if (const auto done = pending->commit(); !done) return done.error();
  return summary;
}

// What is kept of the true changes of a sequence.
struct KeptChanges {
  std::optional<std::string> events;  // The file's bytes. Its views are counted, so it fits any format.
  std::optional<std::vector<ObjectPlacement>> placements;
};

Result<KeptChanges> read_kept_changes(const Sequence& sequence, const ChangeFiles& files) {
  KeptChanges kept;
  if (!files.events.empty()) {
    auto bytes = io::read_file(files.events);
    if (!bytes) return bytes.error();
    kept.events = std::move(*bytes);
  }
  if (files.changes.empty() || !sequence.has_ground_truth()) return kept;
  const auto chains = read_changes(files.changes);
  if (!chains) return chains.error();
  auto placements = resolve_changes(*chains, view_names(sequence), files.changes.string());
  if (!placements) return placements.error();
  kept.placements = std::move(*placements);
  return kept;
}

// Every annotation of this view that a chain names must exist.
Result<void> check_annotated(const KeptChanges& kept, const std::vector<GroundTruthObject>& truth, int view,
                             const std::filesystem::path& file) {
  if (!kept.placements) return {};
  for (const ObjectPlacement& placement : *kept.placements)
    for (const auto& entry : placement.entries)
      if (entry.view == view && std::ranges::none_of(truth, [&](const GroundTruthObject& o) {
            return o.object == placement.object && o.instance == entry.instance;
          }))
        return io::file_error(file, fmt::format("view {} has no annotation of '{}' with instance {}", view,
                                                placement.object, entry.instance));
  return {};
}

Result<void> write_kept_changes(const KeptChanges& kept, const std::string& name, SequenceWriter& writer) {
  if (kept.events)
    if (auto done = writer.add_file("events.json", *kept.events); !done) return done;
  if (!kept.placements) return {};
  return writer.add_file(name + ".changes", format_changes(name_placements(*kept.placements, writer.view_names())));
}

}  // namespace

Result<void> check_view_names(const Sequence& sequence, const std::filesystem::path& directory, DatasetFormat format) {
  if (format != DatasetFormat::kTuw) return {};
  std::string before;
  for (int i = 0; i < sequence.num_views(); ++i) {
    const std::string name = sequence.view_name(i);
    if (const auto done = io::check_tuw_view_name(name, before); !done)
      return io::file_error(directory, done.error().message);
    before = name;
  }
  return {};
}

Result<ConversionSummary> convert_sequence(const Sequence& sequence, const std::filesystem::path& directory,
                                           DatasetFormat format, const ChangeFiles& changes) {
  const auto kept = read_kept_changes(sequence, changes);
  if (!kept) return kept.error();
  if (format == DatasetFormat::kTuw && !sequence.has_poses() && sequence.num_views() > 1)
    return Error{"the views have no camera poses, which TUW files hold: give --poses FILE or fixed, or convert to bop"};
  if (const auto done = check_view_names(sequence, directory, format); !done) return done.error();
  const auto writer = create_sequence(
      directory, format, {.has_poses = sequence.has_poses(), .has_ground_truth = sequence.has_ground_truth()});
  if (!writer) return writer.error();
  ConversionSummary summary;
  for (int i = 0; i < sequence.num_views(); ++i) {
    const auto frame = sequence.read_view(i);
    if (!frame) return frame.error();
    const auto truth = sequence.read_ground_truth(i);
    if (!truth) return truth.error();
    if (const auto done = check_annotated(*kept, *truth, i, changes.changes); !done) return done.error();
    if (const auto done = (*writer)->write_view(*frame, *truth); !done) return done.error();
    ++summary.num_views;
    summary.num_objects += static_cast<int>(truth->size());
  }
  if (const auto done = write_kept_changes(*kept, io::folder_name(directory), **writer); !done) return done.error();
  if (const auto done = (*writer)->finish(); !done) return done.error();
  return summary;
}

Result<ConversionSummary> convert_models(std::span<const ModelLocation> models, const std::filesystem::path& directory,
                                         DatasetFormat format) {
  require(!models.empty(), "convert_models: no models");
  return format == DatasetFormat::kBop ? convert_to_bop(models, directory) : convert_to_tuw(models, directory);
}

}  // namespace resight
