// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <span>
#include <string>

#include "resight/core/result.hpp"
#include "resight/evaluation/evaluation_summary.hpp"
#include "resight/evaluation/paired_difference.hpp"

namespace resight {

/// What the numbers of an evaluation are of.
struct EvaluationHeader {
  std::string dataset;  ///< Name or path, for the reader.
  std::string version;  ///< Of resight.
};

/// All scores of all configurations (docs/formats.md). No times: the same runs give the same bytes.
[[nodiscard]] std::string format_evaluation_json(const EvaluationHeader& header,
                                                 std::span<const ConfigurationSummary> configurations);
/// Seconds per stage and per view, of each configuration.
[[nodiscard]] std::string format_evaluation_times_json(const EvaluationHeader& header,
                                                       std::span<const ConfigurationSummary> configurations);
/// The scores as Markdown tables: recognition over K, ghosts, differences between presets, clustering, changes, losses,
/// objects, visibility. No times.
[[nodiscard]] std::string format_evaluation_tables(const EvaluationHeader& header,
                                                   std::span<const ConfigurationSummary> configurations,
                                                   std::span<const PresetComparison> comparisons = {});
/// The times as Markdown tables.
[[nodiscard]] std::string format_evaluation_times(const EvaluationHeader& header,
                                                  std::span<const ConfigurationSummary> configurations);
/// Writes results.json, times.json, tables.md, times.md, worst.md, and the plots precision.svg, recall.svg, f.svg,
/// ghosts.svg (Fig. 5) and view_time.svg (Fig. 7) into `directory`. Each file appears under its name only when it is
/// whole. `num_pictures`: of the worst views of each configuration, which the caller draws (worst_views.hpp).
[[nodiscard]] Result<void> write_evaluation(const std::filesystem::path& directory, const EvaluationHeader& header,
                                            std::span<const EvaluatedRun> runs, int num_pictures = 0);

}  // namespace resight
