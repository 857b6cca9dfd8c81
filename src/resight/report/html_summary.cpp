// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>

#include "resight/report/internal/html.hpp"

namespace resight::report {
namespace {

using CellText = std::function<std::string(const ReportRun&, const RunSummary&)>;

struct SummaryTable {
  std::span<const ReportRun> runs;
  std::vector<RunSummary> summaries;
  std::string html;

  void add_row(const std::string& name, const CellText& text) {
    html += "<tr><th>" + name + "</th>";
    for (std::size_t i = 0; i < runs.size(); ++i) html += "<td class=\"n\">" + text(runs[i], summaries[i]) + "</td>";
    html += "</tr>\n";
  }
};

std::string score_text(const RecognitionScore& score) {
  return fmt::format("{} / {} / {}", number(score.precision(), 2), number(score.recall(), 2),
                     number(score.f_score(), 2));
}

std::string counts_text(const RecognitionScore& score) {
  return fmt::format("{} / {} / {}", score.true_positives, score.false_positives, score.false_negatives);
}

void add_score_rows(SummaryTable& table) {
  table.add_row("Precision / recall / F <span class=\"soft\">within 5 cm, 30°</span>",
                [](const ReportRun&, const RunSummary& s) { return score_text(s.score); });
  table.add_row("Found / false / missed", [](const ReportRun&, const RunSummary& s) { return counts_text(s.score); });
  table.add_row("Precision / recall / F <span class=\"soft\">within 1 cm, 10°</span>",
                [](const ReportRun&, const RunSummary& s) { return score_text(s.strict_score); });
  table.add_row("Ghosts <span class=\"soft\">objects reported at a place they have left</span>",
                [](const ReportRun&, const RunSummary& s) { return std::to_string(s.num_ghosts); });
  table.add_row("Views with ground truth",
                [](const ReportRun&, const RunSummary& s) { return std::to_string(s.num_scored_views); });
}

void add_cost_rows(SummaryTable& table) {
  table.add_row("Time per view, median",
                [](const ReportRun&, const RunSummary& s) { return duration(s.median_view_wall_s); });
  table.add_row("Time per view, mean",
                [](const ReportRun&, const RunSummary& s) { return duration(s.mean_view_wall_s); });
  table.add_row("Threads", [](const ReportRun& run, const RunSummary&) {
    return run.num_threads > 0 ? std::to_string(run.num_threads) : std::string("–");
  });
  table.add_row("Peak memory of the process", [](const ReportRun& run, const RunSummary&) {
    return run.peak_memory_bytes == 0 ? std::string("–")
                                      : fmt::format("{:.0f} MB", static_cast<double>(run.peak_memory_bytes) / 1e6);
  });
}

std::vector<std::string> stage_names(std::span<const RunSummary> summaries) {
  std::vector<std::string> names;
  for (const RunSummary& summary : summaries) {
    for (const StageTime& time : summary.times.stages()) {
      if (std::find(names.begin(), names.end(), time.stage) == names.end()) names.push_back(time.stage);
    }
  }
  return names;
}

double stage_wall_s(const RunSummary& summary, const std::string& stage) {
  for (const StageTime& time : summary.times.stages()) {
    if (time.stage == stage) return time.wall_s / std::max(1, summary.num_views);
  }
  return std::nan("");
}

std::vector<RunSummary> summarize_all(std::span<const ReportRun> runs) {
  std::vector<RunSummary> summaries;
  for (const ReportRun& run : runs) summaries.push_back(summarize(run));
  return summaries;
}

std::string run_header_row(std::span<const ReportRun> runs) {
  std::string html = "<thead><tr><th></th>";
  for (const ReportRun& run : runs) html += "<th class=\"n\">" + escape(run.preset) + "</th>";
  return html + "</tr></thead>\n";
}

std::string setting_of(const ReportRun& run, const std::string& name) {
  for (const auto& [key, value] : run.settings) {
    if (key == name) return value;
  }
  return "–";
}

}  // namespace

std::string summary_section(std::span<const ReportRun> runs) {
  SummaryTable table{runs, summarize_all(runs), ""};
  table.add_row("Views", [](const ReportRun&, const RunSummary& s) { return std::to_string(s.num_views); });
  table.add_row("Detections", [](const ReportRun&, const RunSummary& s) { return std::to_string(s.num_detections); });
  table.add_row("Objects added, moved or removed",
                [](const ReportRun&, const RunSummary& s) { return std::to_string(s.num_events); });
  const bool judged = std::any_of(table.summaries.begin(), table.summaries.end(),
                                  [](const RunSummary& s) { return s.num_scored_views > 0; });
  if (judged) add_score_rows(table);
  add_cost_rows(table);
  return "<h2 id=\"summary\">Summary</h2>\n<section class=\"card\"><table>" + run_header_row(runs) + "<tbody>\n" +
         table.html + "</tbody></table></section>\n";
}

std::string time_section(std::span<const ReportRun> runs) {
  const std::vector<RunSummary> summaries = summarize_all(runs);
  const std::vector<std::string> names = stage_names(summaries);
  if (names.empty()) return "";
  double longest = 0;
  for (const RunSummary& summary : summaries) {
    for (const std::string& name : names) {
      const double wall_s = stage_wall_s(summary, name);
      if (wall_s > longest) longest = wall_s;
    }
  }
  std::string html =
      "<h2 id=\"time\">Time per stage</h2>\n<p class=\"soft\">Wall time, mean per view.</p>\n"
      "<section class=\"card\"><table><thead><tr><th>Stage</th>";
  for (const ReportRun& run : runs) html += "<th class=\"n\">" + escape(run.preset) + "</th><th></th>";
  html += "</tr></thead><tbody>\n";
  for (const std::string& name : names) {
    html += "<tr><td>" + escape(name) + "</td>";
    for (const RunSummary& summary : summaries) {
      const double wall_s = stage_wall_s(summary, name);
      const double width_px = longest > 0 && !std::isnan(wall_s) ? 160 * wall_s / longest : 0;
      fmt::format_to(std::back_inserter(html),
                     "<td class=\"n\">{}</td><td><span class=\"bar\" style=\"width:{:.0f}px\"></span></td>",
                     duration(wall_s), width_px);
    }
    html += "</tr>\n";
  }
  return html + "</tbody></table></section>\n";
}

std::string settings_section(std::span<const ReportRun> runs) {
  std::vector<std::string> names;
  for (const ReportRun& run : runs) {
    for (const auto& [name, value] : run.settings) {
      if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
    }
  }
  if (names.empty()) return "";
  std::string html = "<h2 id=\"settings\">Settings</h2>\n<section class=\"card\"><details><summary>All " +
                     std::to_string(names.size()) + " settings; differences in bold</summary><table>" +
                     run_header_row(runs) + "<tbody>\n";
  for (const std::string& name : names) {
    const std::string first = setting_of(runs.front(), name);
    const bool differs =
        std::any_of(runs.begin(), runs.end(), [&](const ReportRun& run) { return setting_of(run, name) != first; });
    const char* open = differs ? "<b>" : "";
    const char* close = differs ? "</b>" : "";
    html += fmt::format("<tr><td>{}{}{}</td>", open, escape(name), close);
    for (const ReportRun& run : runs) {
      html += fmt::format("<td class=\"n\">{}{}{}</td>", open, escape(setting_of(run, name)), close);
    }
    html += "</tr>\n";
  }
  return html + "</tbody></table></details></section>\n";
}

}  // namespace resight::report
