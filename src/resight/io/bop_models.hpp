// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <map>
#include <memory>
#include <span>

#include "resight/io/model_source.hpp"

namespace resight {

/// Writes models into a BOP data set one by one: meshes (or, without one, surface clouds) as models/obj_%06d.ply in
/// millimetres with models_info.json (diameter, box, symmetries, and our key "name"), training views as train/%06d.
/// Both folders appear with finish(); neither may exist before.
class BopModelsWriter {
 public:
  [[nodiscard]] static Result<std::unique_ptr<BopModelsWriter>> create(const std::filesystem::path& dataset);
  ~BopModelsWriter();
  BopModelsWriter(const BopModelsWriter&) = delete;
  BopModelsWriter& operator=(const BopModelsWriter&) = delete;
  /// `bop_id` > 0, different for each model.
  [[nodiscard]] Result<void> write_model(const ModelSource& model, int bop_id);
  [[nodiscard]] Result<void> finish();

 private:
  struct State;
  explicit BopModelsWriter(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

/// All models at once. Those with bop_id 0 get the smallest free ids, in order.
[[nodiscard]] Result<void> write_bop_models(const std::filesystem::path& dataset, std::span<const ModelSource> models);

/// The given ids with each 0 replaced by the smallest one that is free. Error if one is there twice or negative.
[[nodiscard]] Result<std::vector<int>> assign_bop_ids(std::span<const int> ids);

}  // namespace resight
