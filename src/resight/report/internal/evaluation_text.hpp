// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <span>
#include <string>
#include <vector>

#include "resight/report/evaluation_report.hpp"

namespace resight::report {

/// Formats a number with `digits` decimals; NaN as "-".
[[nodiscard]] std::string format_number(double value, int digits);
/// Formats the preset as code, followed by "without clustering" if that is so.
[[nodiscard]] std::string configuration_name(const ConfigurationSummary& configuration);
/// Formats the title of a page of results, and a sentence on what was evaluated.
[[nodiscard]] std::string evaluation_title(const char* what, const EvaluationHeader& header,
                                           std::span<const ConfigurationSummary> configurations);

/// One configuration with clustering and without it.
struct ClusteringPair {
  const ConfigurationSummary* without = nullptr;
  const ConfigurationSummary* with = nullptr;
};
[[nodiscard]] std::vector<ClusteringPair> find_clustering_pairs(std::span<const ConfigurationSummary> configurations);

}  // namespace resight::report
