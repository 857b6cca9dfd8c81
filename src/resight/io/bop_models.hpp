// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <memory>
#include <span>

#include "resight/io/model_source.hpp"

namespace resight {

/// Writes models to a BOP data set one by one. Meshes (or surface clouds, if there is no mesh) become
/// models/obj_%06d.ply in millimetres, with models_info.json (diameter, box, symmetries, and our key "name"). Training
/// views become train/%06d. Both folders appear with finish(); existing ones must be empty.
class BopModelsWriter {
 public:
  /// Fails if `dataset`/models exists and is not empty, or cannot be written.
  [[nodiscard]] static Result<std::unique_ptr<BopModelsWriter>> create(const std::filesystem::path& dataset);
  ~BopModelsWriter();
  BopModelsWriter(const BopModelsWriter&) = delete;
  BopModelsWriter& operator=(const BopModelsWriter&) = delete;
  /// `bop_id` must be > 0 and unique.
  [[nodiscard]] Result<void> write_model(const ModelSource& model, int bop_id);
  /// Moves both folders to their final names.
  [[nodiscard]] Result<void> finish();

 private:
  struct State;
  explicit BopModelsWriter(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

/// Replaces each 0 by the smallest free id. Fails if an id occurs twice or is negative.
[[nodiscard]] Result<std::vector<int>> assign_bop_ids(std::span<const int> ids);

}  // namespace resight
