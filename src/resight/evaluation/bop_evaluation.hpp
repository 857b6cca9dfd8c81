// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "resight/core/result.hpp"
#include "resight/evaluation/bop_average_recall.hpp"
#include "resight/evaluation/evaluated_run.hpp"
#include "resight/models/object_model.hpp"
#include "resight/sensor/sequence.hpp"

namespace resight {

/// Reads the meshes of all models under `path`, by name, and also by the name that the library has for their obj_id.
/// Models without a mesh are skipped, and their ground truth is ignored.
[[nodiscard]] Result<std::map<std::string, BopObject>> read_bop_objects(const std::filesystem::path& path,
                                                                        const ModelLibrary& library);

/// BOP average recalls of one configuration over all its sequences.
struct BopConfiguration {
  std::string preset;
  int num_previous_views = 0;
  bool is_clustered = true;
  BopAverageRecall recall;
};

/// Scores stored runs with BOP's errors, from their detections. `open` opens a sequence by name; its ground truth has
/// the names of read_sequence_truth(). Configurations are in the order of their first run. If a run lacks views of its
/// sequence, they count as views without detections.
[[nodiscard]] Result<std::vector<BopConfiguration>> evaluate_bop(
    std::span<const EvaluatedRun> runs, const std::map<std::string, BopObject>& objects, const ModelLibrary& library,
    const std::function<Result<std::unique_ptr<Sequence>>(const std::string&)>& open);

/// Formats the results as a Markdown table.
[[nodiscard]] std::string format_bop_table(std::span<const BopConfiguration> configurations);

}  // namespace resight
