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

}  // namespace resight::report
