// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <span>
#include <string>

#include "resight/core/result.hpp"
#include "resight/report/view_record.hpp"

namespace resight {

/// The report of a longer run is divided into pages of so many views.
inline constexpr int kViewsPerPage = 100;
/// The folder of these pages, beside the report.
inline constexpr const char* kReportPages = "report_pages";

/// Formats the runs side by side as one self-contained HTML page: objects and their changes, scores if there is ground
/// truth, times, and each view with its overlay, detections and events. The runs may use different presets on one
/// sequence; views are aligned by their numbers. If a run has more than kViewsPerPage views, this is the first page: it
/// shows the first views with changes in place of all, and leads to the other pages. Throws std::invalid_argument
/// without a run.
[[nodiscard]] std::string format_report(const std::string& title, std::span<const ReportRun> runs,
                                        const ModelLibrary& library);

/// Formats the page of the views from `page` * kViewsPerPage on: their history and the views.
[[nodiscard]] std::string format_report_page(const std::string& title, std::span<const ReportRun> runs,
                                             const ModelLibrary& library, int page);

/// Writes format_report() to a file, and the other pages, if there are any, to kReportPages beside it. Each file
/// appears under its name only when it is complete. Creates the folders if necessary.
[[nodiscard]] Result<void> write_report(const std::filesystem::path& path, const std::string& title,
                                        std::span<const ReportRun> runs, const ModelLibrary& library);

/// Moves the picture of a view from memory to a file in kReportPages of `folder`, where the report will be. A long run
/// needs no memory for pictures then.
[[nodiscard]] Result<void> store_picture(ViewRecord& view, const std::filesystem::path& folder);

/// Removes the pages and pictures that a report in `folder` of a run of `num_views` views does not have: those of a
/// longer run before it. Other files stay.
void remove_old_pages(const std::filesystem::path& folder, int num_views);

}  // namespace resight
