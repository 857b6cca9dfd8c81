// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <span>
#include <string>

#include "resight/report/evaluation_report.hpp"

namespace resight::report {

/// Formats a number with `digits` decimals; NaN as "-".
[[nodiscard]] std::string format_number(double value, int digits);
/// Formats the preset as code, followed by "without clustering" if that is so.
[[nodiscard]] std::string configuration_name(const ConfigurationSummary& configuration);
/// Formats the title of a page of results, and a sentence on what was evaluated.
[[nodiscard]] std::string evaluation_title(const char* what, const EvaluationHeader& header,
                                           std::span<const ConfigurationSummary> configurations);

}  // namespace resight::report
