// SPDX-License-Identifier: Apache-2.0
#include "resight/report/results.hpp"

#include <utility>

#include "resight/core/files.hpp"
#include "resight/core/output_file.hpp"
#include "resight/report/internal/results_text.hpp"

namespace resight {
namespace {

using PutText = void (*)(const ReportRun& run, const ModelLibrary& library, const report::TextSink& sink);

std::string text_of(PutText put, const ReportRun& run, const ModelLibrary& library) {
  std::string text;
  put(run, library, [&text](std::string_view part) { text += part; });
  return text;
}

Result<void> write_text_of(PutText put, const std::filesystem::path& file, const ReportRun& run,
                           const ModelLibrary& library) {
  auto out = OutputFile::create(file);
  if (!out) return out.error();
  Result<void> written;
  put(run, library, [&](std::string_view part) {
    if (written) written = out->append(part);
  });
  return written ? out->commit() : written;
}

}  // namespace

std::string format_detections_csv(const ReportRun& run, const ModelLibrary& library) {
  return text_of(report::put_detections_csv, run, library);
}

std::string format_detections_json(const ReportRun& run, const ModelLibrary& library) {
  return text_of(report::put_detections_json, run, library);
}

std::string format_changes_json(const ReportRun& run, const ModelLibrary& library) {
  return text_of(report::put_changes_json, run, library);
}

Result<void> write_results(const std::filesystem::path& directory, const ReportRun& run, const ModelLibrary& library) {
  const std::pair<const char*, PutText> files[] = {{"detections.csv", report::put_detections_csv},
                                                   {"detections.json", report::put_detections_json},
                                                   {"changes.json", report::put_changes_json}};
  for (const auto& [name, put] : files)
    if (auto written = write_text_of(put, directory / name, run, library); !written) return written;
  return write_file(directory / "summary.json", format_summary_json(run));
}

}  // namespace resight
