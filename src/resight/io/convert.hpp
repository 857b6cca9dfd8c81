// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <span>

#include "resight/io/model_source.hpp"
#include "resight/io/sequence.hpp"

namespace resight {

/// What a conversion has written.
struct ConversionSummary {
  int num_views = 0;                  ///< Of sequences, or training views of models.
  int num_objects = 0;                ///< Ground truth entries, or models.
  std::vector<std::string> warnings;  ///< ModelSource::warnings of all models.
};

/// Writes every view of `sequence`, with its ground truth, as `directory` in another format. What is lost
/// (docs/formats.md): to BOP, depth is rounded to 0.1 mm (1 mm beyond 6.5 m) and views get numbers for names; to TUW,
/// obj_ids.
[[nodiscard]] Result<ConversionSummary> convert_sequence(const Sequence& sequence,
                                                         const std::filesystem::path& directory, DatasetFormat format);

/// Writes models one after the other: to BOP as models/ and train/ of the data set `directory` (BopModelsWriter), to
/// TUW as one folder each. A mesh has no views: to make a TUW model of it they have to be rendered first; an error
/// here.
[[nodiscard]] Result<ConversionSummary> convert_models(std::span<const ModelLocation> models,
                                                       const std::filesystem::path& directory, DatasetFormat format);

}  // namespace resight
