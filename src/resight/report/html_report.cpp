// SPDX-License-Identifier: Apache-2.0
#include "resight/report/html_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <optional>
#include <system_error>
#include <vector>

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
  const std::pair<const char*, const char*> sections[] = {{"summary", "Summary"}, {"history", "Objects"},
                                                          {"time", "Time"},       {"views", "Views"},
                                                          {"pages", "Pages"},     {"settings", "Settings"}};
  std::string html = "<nav>";
  for (const auto& [id, name] : sections) {
    if (body.find("<h2 id=\"" + std::string(id) + "\"") == std::string::npos) continue;
    html += "<a href=\"#" + std::string(id) + "\">" + name + "</a>";
  }
  return html + "</nav>\n";
}

std::string page_around(const std::string& title, const std::string& top, const std::string& body) {
  const std::string safe_title = report::escape(title);
  return "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
         "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<title>" +
         safe_title + "</title>\n<style>" + std::string(report::page_style()) + "</style>\n</head>\n<body>\n<h1>" +
         safe_title + "</h1>\n" + top + body + "</body>\n</html>\n";
}

int num_pages(int num_views) {
  return num_views <= kViewsPerPage ? 0 : (num_views + kViewsPerPage - 1) / kViewsPerPage;
}

report::ViewRange views_of_page(int page, int num_views) {
  return {page * kViewsPerPage, std::min(num_views, (page + 1) * kViewsPerPage)};
}

std::string page_file(int page) { return fmt::format("views_{:06}.html", page * kViewsPerPage); }
std::string picture_file(int view) { return fmt::format("view_{:06}.jpg", view); }

std::string page_name(const report::ViewRange& range) {
  return fmt::format("views {} to {}", range.first, range.end - 1);
}

std::string link_to(const std::string& file, const std::string& text) {
  return fmt::format("<a href=\"{}\">{}</a>", file, text);
}

std::string pages_section(int num_views) {
  std::string html =
      "<h2 id=\"pages\">Pages</h2>\n<section class=\"card\"><p class=\"soft\">Each view with its picture, "
      "detections and events.</p>\n<nav>";
  for (int page = 0; page < num_pages(num_views); ++page)
    html +=
        link_to(fmt::format("{}/{}", kReportPages, page_file(page)), page_name(views_of_page(page, num_views))) + "\n";
  return html + "</nav></section>\n";
}

/// The number of the view or page that a file of ours is named after.
std::optional<int> number_in(const std::string& name, std::string_view start, std::string_view end) {
  if (!name.starts_with(start) || !name.ends_with(end) || name.size() <= start.size() + end.size()) return std::nullopt;
  const char* const first = name.data() + start.size();
  const char* const last = name.data() + name.size() - end.size();
  int number = 0;
  const auto [stop, error] = std::from_chars(first, last, number);
  return error == std::errc() && stop == last ? std::optional(number) : std::nullopt;
}

bool is_old_page(const std::string& name, int num_views) {
  const auto page = number_in(name, "views_", ".html");
  const auto picture = number_in(name, "view_", ".jpg");
  const int first_old = num_pages(num_views) == 0 ? 0 : num_views;
  return (page && *page >= first_old) || (picture && *picture >= first_old);
}

}  // namespace

std::string format_report(const std::string& title, std::span<const ReportRun> runs, const ModelLibrary& library) {
  require(!runs.empty(), "format_report: there must be at least one run");
  const report::ViewRange all = report::range_of(runs);
  const bool has_pages = num_pages(all.end) > 0;
  const std::string body =
      report::summary_section(runs) +
      (has_pages ? report::changes_section(runs, library) : report::history_section(runs, library, all)) +
      report::time_section(runs) + (has_pages ? pages_section(all.end) : report::views_section(runs, library, all)) +
      report::settings_section(runs);
  return page_around(title, lead_line(runs.front()) + navigation(body), body);
}

std::string format_report_page(const std::string& title, std::span<const ReportRun> runs, const ModelLibrary& library,
                               int page) {
  const int num_views = report::range_of(runs).end;
  const report::ViewRange range = views_of_page(page, num_views);
  std::string links = "<nav>" + link_to("../report.html", "Summary");
  if (page > 0) links += link_to(page_file(page - 1), "Previous page");
  if (page + 1 < num_pages(num_views)) links += link_to(page_file(page + 1), "Next page");
  links += "</nav>\n";
  return page_around(
      title + ", " + page_name(range), links,
      report::history_section(runs, library, range) + report::views_section(runs, library, range) + links);
}

Result<void> write_report(const std::filesystem::path& path, const std::string& title, std::span<const ReportRun> runs,
                          const ModelLibrary& library) {
  const int count = num_pages(report::range_of(runs).end);
  for (int page = 0; page < count; ++page)
    if (auto written = write_file(path.parent_path() / kReportPages / page_file(page),
                                  format_report_page(title, runs, library, page));
        !written)
      return written;
  return write_file(path, format_report(title, runs, library));
}

Result<void> store_picture(ViewRecord& view, const std::filesystem::path& folder) {
  if (view.picture_jpeg.empty()) return {};
  view.picture_file = picture_file(view.update.view);
  const std::string_view bytes(reinterpret_cast<const char*>(view.picture_jpeg.data()), view.picture_jpeg.size());
  if (auto written = write_file(folder / kReportPages / view.picture_file, bytes); !written) return written;
  view.picture_jpeg = {};
  return {};
}

void remove_old_pages(const std::filesystem::path& folder, int num_views) {
  namespace fs = std::filesystem;
  std::error_code error;
  std::vector<fs::path> old;
  for (fs::directory_iterator it(folder / kReportPages, error), end; !error && it != end; it.increment(error))
    if (is_old_page(it->path().filename().string(), num_views)) old.push_back(it->path());
  for (const fs::path& file : old) fs::remove(file, error);
  if (num_pages(num_views) == 0) fs::remove(folder / kReportPages, error);  // Only if it is empty.
}

}  // namespace resight
