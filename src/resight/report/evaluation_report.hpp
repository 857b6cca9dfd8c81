// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <span>
#include <string>

#include "resight/core/result.hpp"
#include "resight/evaluation/evaluation_summary.hpp"
#include "resight/evaluation/paired_difference.hpp"

namespace resight {

/// What was evaluated.
struct EvaluationHeader {
  std::string dataset;  ///< Name or path, for display.
  std::string version;  ///< Version of resight.
};

/// Formats all scores of all configurations as JSON (docs/formats.md). Contains no times, so that the same runs give
/// the same bytes.
[[nodiscard]] std::string format_evaluation_json(const EvaluationHeader& header,
                                                 std::span<const ConfigurationSummary> configurations);
/// Formats the seconds per stage and per view of each configuration as JSON.
[[nodiscard]] std::string format_evaluation_times_json(const EvaluationHeader& header,
                                                       std::span<const ConfigurationSummary> configurations);
/// Formats the scores as Markdown tables: recognition over K, ghosts, differences between presets, clustering, changes,
/// losses, objects, visibility. Contains no times.
[[nodiscard]] std::string format_evaluation_tables(const EvaluationHeader& header,
                                                   std::span<const ConfigurationSummary> configurations,
                                                   std::span<const PresetComparison> comparisons = {});
/// Formats the times as Markdown tables: per view with the share of change detection (paper, Sec. IV-B), of clustering
/// (Table III), and per stage.
[[nodiscard]] std::string format_evaluation_times(const EvaluationHeader& header,
                                                  std::span<const ConfigurationSummary> configurations);
/// Formats the time of verification in every view of every run as CSV, and the number of hypotheses after clustering
/// (paper, Fig. 7).
[[nodiscard]] std::string format_verification_times(std::span<const EvaluatedRun> runs);

/// Writes results.json, times.json, tables.md, times.md, worst.md, verification_times.csv, and the plots precision.svg,
/// recall.svg, f.svg, ghosts.svg (paper, Fig. 5), view_time.svg and verification_time.svg (Fig. 7: the longest
/// sequence, the largest K of each preset, with and without clustering) to `directory`. Each file appears under its
/// name only when it is complete. `num_pictures`: pictures of the worst views per configuration that the report refers
/// to; the caller draws them (worst_views.hpp).
[[nodiscard]] Result<void> write_evaluation(const std::filesystem::path& directory, const EvaluationHeader& header,
                                            std::span<const EvaluatedRun> runs, int num_pictures = 0);

}  // namespace resight
