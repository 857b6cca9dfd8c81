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
#include "resight/io/model_source.hpp"
#include "resight/io/sequence.hpp"

namespace resight {

/// The meshes of all models under `path`; models without a mesh are left out, and so is their truth.
[[nodiscard]] Result<std::map<std::string, BopObject>> read_bop_objects(const std::filesystem::path& path);

/// BOP's average recalls of one configuration over all its sequences.
struct BopConfiguration {
  std::string preset;
  int num_previous_views = 0;
  bool is_clustered = true;
  BopAverageRecall recall;
};

/// Scores stored runs by BOP's errors, from their detections. `open` opens the sequence of that name. In order of the
/// first run of each configuration. Views of a sequence that a run lacks count as views without detections.
[[nodiscard]] Result<std::vector<BopConfiguration>> evaluate_bop(
    std::span<const EvaluatedRun> runs, const std::map<std::string, BopObject>& objects,
    const std::function<Result<std::unique_ptr<Sequence>>(const std::string&)>& open);

/// As a Markdown table.
[[nodiscard]] std::string format_bop_table(std::span<const BopConfiguration> configurations);

}  // namespace resight
