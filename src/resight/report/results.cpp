// SPDX-License-Identifier: Apache-2.0
#include "resight/report/results.hpp"

#include <utility>

#include "resight/core/files.hpp"

namespace resight {

Result<void> write_results(const std::filesystem::path& directory, const ReportRun& run, const ModelLibrary& library) {
  // All texts are formatted before the first is written, so that an error in one leaves no partial set.
  const std::pair<const char*, std::string> files[] = {{"detections.csv", format_detections_csv(run, library)},
                                                       {"detections.json", format_detections_json(run, library)},
                                                       {"changes.json", format_changes_json(run, library)},
                                                       {"summary.json", format_summary_json(run)}};
  for (const auto& [name, text] : files) {
    const Result<void> written = write_file(directory / name, text);
    if (!written.ok()) return written;
  }
  return {};
}

}  // namespace resight
