// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <span>
#include <string>

#include "resight/core/result.hpp"
#include "resight/report/view_record.hpp"

namespace resight {

/// Formats the runs side by side as one self-contained HTML page: objects and their changes, scores if there is ground
/// truth, times, and each view with its overlay, detections and events. The runs may use different presets on one
/// sequence; views are aligned by their numbers. Throws std::invalid_argument without a run.
[[nodiscard]] std::string format_report(const std::string& title, std::span<const ReportRun> runs,
                                        const ModelLibrary& library);

/// Writes format_report() to a file, which appears under its name only when it is complete. Creates the folder if
/// necessary.
[[nodiscard]] Result<void> write_report(const std::filesystem::path& path, const std::string& title,
                                        std::span<const ReportRun> runs, const ModelLibrary& library);

}  // namespace resight
