// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <span>
#include <string>

#include "resight/core/result.hpp"
#include "resight/report/view_record.hpp"

namespace resight {

/// The runs side by side as one HTML page that needs no other file and no network: what was found and when it changed,
/// scores where there is ground truth, times, and each view with its overlay, detections and events. The runs may be of
/// different presets over one sequence; views are lined up by their number. Throws std::invalid_argument without a run.
[[nodiscard]] std::string format_report(const std::string& title, std::span<const ReportRun> runs,
                                        const ModelLibrary& library);

/// format_report() into a file, which appears under its name only when it is whole; its folder is made if it is
/// missing.
[[nodiscard]] Result<void> write_report(const std::filesystem::path& path, const std::string& title,
                                        std::span<const ReportRun> runs, const ModelLibrary& library);

}  // namespace resight
