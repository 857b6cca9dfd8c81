// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <limits>
#include <set>
#include <string_view>

#include "resight/core/printable.hpp"
#include "resight/report/evaluation_report.hpp"
#include "resight/report/internal/evaluation_text.hpp"

namespace resight {
namespace {

using report::ClusteringPair;
using report::configuration_name;
using report::evaluation_title;
using report::find_clustering_pairs;
using report::format_number;

constexpr double kNoTime = std::numeric_limits<double>::quiet_NaN();

StageTime time_of(const StageTimes& times, std::string_view stage) {
  const auto found = std::ranges::find(times.stages(), stage, &StageTime::stage);
  return found == times.stages().end() ? StageTime{} : *found;
}

// CPU milliseconds per view.
double cpu_ms(const ConfigurationSummary& c, std::string_view stage) {
  return 1e3 * time_of(c.times.stages, stage).cpu_s / c.num_views;
}
double all_cpu_ms(const ConfigurationSummary& c) {
  double sum_ms = 0;
  for (const StageTime& stage : c.times.stages.stages()) sum_ms += 1e3 * stage.cpu_s / c.num_views;
  return sum_ms;
}

double percent(double part, double whole) { return whole > 0 ? 100 * part / whole : kNoTime; }

// Paper, Sec. IV-B. `mvr` detects no changes, so its second column is the time of the reconstruction alone.
std::string view_time_table(std::span<const ConfigurationSummary> configurations) {
  std::string text =
      "\n## Time per view (Section IV-B)\n\n`mvr` detects no changes: its \"changes and reconstruction\" is "
      "reconstruction alone.\n\n"
      "| preset | K | wall ms per view | CPU ms per view | changes and reconstruction, CPU ms | presence, CPU ms | "
      "share of both | cluster, CPU ms | verification, CPU ms |\n|---|---|---|---|---|---|---|---|---|\n";
  for (const ConfigurationSummary& c : configurations) {
    const double changes_ms = cpu_ms(c, "changes and reconstruction");
    const double presence_ms = cpu_ms(c, "presence");
    text +=
        fmt::format("| {} | {} | {:.1f} | {:.1f} | {:.1f} | {:.1f} | {} % | {:.1f} | {:.1f} |\n", configuration_name(c),
                    c.num_previous_views, 1e3 * c.times.stages.total_wall_s() / c.num_views, all_cpu_ms(c), changes_ms,
                    presence_ms, format_number(percent(changes_ms + presence_ms, all_cpu_ms(c)), 1),
                    cpu_ms(c, "cluster"), cpu_ms(c, "verification"));
  }
  return text;
}

// Paper, Table III.
std::string clustering_time_table(std::span<const ConfigurationSummary> configurations) {
  std::string rows;
  for (const ClusteringPair& pair : find_clustering_pairs(configurations)) {
    const double saved_ms = cpu_ms(*pair.without, "verification") - cpu_ms(*pair.with, "verification");
    rows += fmt::format("| `{}` | {} | {:.1f} | {:.1f} | {:.1f} | {:.1f} | {} % |\n", pair.with->preset,
                        pair.with->num_previous_views, cpu_ms(*pair.with, "cluster"),
                        cpu_ms(*pair.without, "verification"), cpu_ms(*pair.with, "verification"), saved_ms,
                        format_number(percent(saved_ms, cpu_ms(*pair.without, "verification")), 1));
  }
  if (rows.empty()) return {};
  return "\n## Time of clustering (Table III)\n\nCPU ms per view.\n\n"
         "| preset | K | clustering | verification without | verification with | saved | share saved |\n"
         "|---|---|---|---|---|---|---|\n" +
         rows;
}

std::string stage_table(const ConfigurationSummary& c) {
  std::string text = fmt::format("\n## {}, K = {}\n\n| stage | wall ms per view | CPU ms per view |\n|---|---|---|\n",
                                 configuration_name(c), c.num_previous_views);
  for (const StageTime& stage : c.times.stages.stages())
    text += fmt::format("| {} | {:.2f} | {:.2f} |\n", stage.stage, 1e3 * stage.wall_s / c.num_views,
                        1e3 * stage.cpu_s / c.num_views);
  return text +
         fmt::format("| all | {:.2f} | {:.2f} |\n", 1e3 * c.times.stages.total_wall_s() / c.num_views, all_cpu_ms(c));
}

/// Folders may have any name.
std::string to_csv_field(const std::string& name) {
  const std::string shown = printable(name);
  if (shown.find_first_of(",\"") == shown.npos) return shown;
  std::string quoted = "\"";
  for (const char c : shown) quoted += c == '"' ? std::string(2, c) : std::string(1, c);
  return quoted + "\"";
}

}  // namespace

std::string format_evaluation_times(const EvaluationHeader& header,
                                    std::span<const ConfigurationSummary> configurations) {
  std::set<int> num_threads;
  for (const ConfigurationSummary& c : configurations) num_threads.merge(std::set(c.times.num_threads));
  std::string text = evaluation_title("Times", header, configurations) +
                     fmt::format(" Threads: {}.", fmt::join(num_threads, ", ")) +
                     " Per view. Features, matching and hypotheses of a view are computed once and counted in "
                     "every configuration that uses them.\n";
  text += view_time_table(configurations) + clustering_time_table(configurations);
  for (const ConfigurationSummary& c : configurations) text += stage_table(c);
  return text;
}

std::string format_verification_times(std::span<const EvaluatedRun> runs) {
  std::string text = "sequence,preset,num_previous_views,is_clustered,view,hypotheses,wall_s,cpu_s\n";
  for (const EvaluatedRun& run : runs)
    for (std::size_t v = 0; v < run.views.size(); ++v) {
      const StageTime time = time_of(run.views[v].times, "verification");
      text += fmt::format("{},{},{},{},{},{},{:.6f},{:.6f}\n", to_csv_field(run.sequence), run.preset,
                          run.num_previous_views, run.is_clustered ? 1 : 0, v, run.views[v].counts.clustered,
                          time.wall_s, time.cpu_s);
    }
  return text;
}

}  // namespace resight
