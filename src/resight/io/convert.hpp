// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <span>

#include "resight/io/change_files.hpp"
#include "resight/io/model_source.hpp"
#include "resight/io/sequence.hpp"

namespace resight {

/// Summary of a conversion.
struct ConversionSummary {
  int num_views = 0;                  ///< Views of the sequence, or training views of the models.
  int num_objects = 0;                ///< Ground truth entries, or models.
  std::vector<std::string> warnings;  ///< ModelSource::warnings of all models.
};

/// Fails if the format cannot hold the names of the views, as convert_sequence() does.
[[nodiscard]] Result<void> check_view_names(const Sequence& sequence, const std::filesystem::path& directory,
                                            DatasetFormat format);

/// Writes all views of `sequence` with their ground truth to `directory` in another format. The files of its true
/// changes go into the same folder: the events as they are, as `events.json`; the chains with the new names of the
/// views, as `<name of directory>.changes`, unless there is no ground truth that they could refer to. Fails if the
/// chains do not fit the views and their ground truth. Losses (docs/formats.md): BOP rounds depth to 0.1 mm (1 mm
/// beyond 6.5 m) and names views by numbers; TUW has no obj_ids.
[[nodiscard]] Result<ConversionSummary> convert_sequence(const Sequence& sequence,
                                                         const std::filesystem::path& directory, DatasetFormat format,
                                                         const ChangeFiles& changes = {});

/// Writes models one by one: to BOP as models/ and train/ of the data set `directory` (BopModelsWriter), to TUW as one
/// folder each. `directory` must be empty or not exist, and appears only when it is complete. Fails for a mesh without
/// views if the format is TUW, because its views would have to be rendered first.
[[nodiscard]] Result<ConversionSummary> convert_models(std::span<const ModelLocation> models,
                                                       const std::filesystem::path& directory, DatasetFormat format);

}  // namespace resight
