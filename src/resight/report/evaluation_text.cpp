// SPDX-License-Identifier: Apache-2.0
#include "resight/report/internal/evaluation_text.hpp"

#include <fmt/format.h>

#include <cmath>

#include "resight/report/internal/markdown.hpp"

namespace resight::report {

std::string format_number(double value, int digits) {
  return std::isnan(value) ? "-" : fmt::format("{:.{}f}", value, digits);
}

std::string configuration_name(const ConfigurationSummary& configuration) {
  return fmt::format("`{}`{}", configuration.preset, configuration.is_clustered ? "" : " without clustering");
}

std::string evaluation_title(const char* what, const EvaluationHeader& header,
                             std::span<const ConfigurationSummary> configurations) {
  return fmt::format("# {}: {}\n\nresight {}, {} sequences, {} views.", what, escape_markdown(header.dataset),
                     header.version, configurations.empty() ? 0 : configurations.front().num_sequences,
                     configurations.empty() ? 0 : configurations.front().num_views);
}

std::vector<ClusteringPair> find_clustering_pairs(std::span<const ConfigurationSummary> configurations) {
  std::vector<ClusteringPair> pairs;
  for (const ConfigurationSummary& without : configurations)
    for (const ConfigurationSummary& with : configurations)
      if (!without.is_clustered && with.is_clustered && with.preset == without.preset &&
          with.num_previous_views == without.num_previous_views)
        pairs.push_back({&without, &with});
  return pairs;
}

}  // namespace resight::report
