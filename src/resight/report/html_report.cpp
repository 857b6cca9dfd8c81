// SPDX-License-Identifier: Apache-2.0
#include "resight/report/html_report.hpp"

#include "resight/core/check.hpp"
#include "resight/core/files.hpp"
#include "resight/report/internal/html.hpp"

namespace resight {
namespace {

std::string lead_line(const ReportRun& run) {
  std::string html = "<p class=\"lead\">";
  if (!run.sequence.empty()) html += "Sequence " + report::escape(run.sequence);
  if (!run.version.empty()) html += (run.sequence.empty() ? "resight " : " · resight ") + report::escape(run.version);
  if (!run.sequence_path.empty()) html += " · in 3D: <code>resight view</code> with the folder of the results";
  return html + "</p>\n";
}

std::string navigation(const std::string& body) {
  const std::pair<const char*, const char*> sections[] = {
      {"summary", "Summary"}, {"history", "Objects"}, {"time", "Time"}, {"views", "Views"}, {"settings", "Settings"}};
  std::string html = "<nav>";
  for (const auto& [id, name] : sections) {
    if (body.find("<h2 id=\"" + std::string(id) + "\"") == std::string::npos) continue;
    html += "<a href=\"#" + std::string(id) + "\">" + name + "</a>";
  }
  return html + "</nav>\n";
}

}  // namespace

std::string format_report(const std::string& title, std::span<const ReportRun> runs, const ModelLibrary& library) {
  require(!runs.empty(), "format_report: there must be at least one run");
  const std::string body = report::summary_section(runs) + report::history_section(runs, library) +
                           report::time_section(runs) + report::views_section(runs, library) +
                           report::settings_section(runs);
  const std::string safe_title = report::escape(title);
  return "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
         "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<title>" +
         safe_title + "</title>\n<style>" + std::string(report::page_style()) + "</style>\n</head>\n<body>\n<h1>" +
         safe_title + "</h1>\n" + lead_line(runs.front()) + navigation(body) + body + "</body>\n</html>\n";
}

Result<void> write_report(const std::filesystem::path& path, const std::string& title, std::span<const ReportRun> runs,
                          const ModelLibrary& library) {
  return write_file(path, format_report(title, runs, library));
}

}  // namespace resight
