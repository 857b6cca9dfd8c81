// SPDX-License-Identifier: Apache-2.0
#include "resight/report/evaluation_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <utility>

#include "resight/core/files.hpp"
#include "resight/report/line_plot.hpp"
#include "resight/report/worst_views.hpp"

namespace resight {
namespace {

std::string series_name(const ConfigurationSummary& c) { return c.preset + (c.is_clustered ? "" : " (no clustering)"); }

// One line per preset over K, separately with and without clustering.
std::string plot_over_k(const std::string& title, const std::string& y_label,
                        std::span<const ConfigurationSummary> configurations,
                        const std::function<double(const ConfigurationSummary&)>& value, bool is_share) {
  LinePlot plot{title, "K (views before the current one)", y_label, {}, {}, {}};
  if (is_share) {
    plot.y_min = 0;
    plot.y_max = 1;
  }
  for (const ConfigurationSummary& c : configurations) {
    if (plot.series.empty() || plot.series.back().name != series_name(c))
      plot.series.push_back({series_name(c), {}, {}});
    plot.series.back().x.push_back(c.num_previous_views);
    plot.series.back().y.push_back(value(c));
  }
  return format_svg(plot);
}

// For the largest K of each preset: the time of a view grows with its number until the window is full.
std::string plot_view_times(std::span<const ConfigurationSummary> configurations) {
  LinePlot plot{"Time per view over the sequence", "view", "seconds", {}, {}, {}};
  for (std::size_t i = 0; i < configurations.size(); ++i) {
    const ConfigurationSummary& c = configurations[i];
    if (i + 1 < configurations.size() && series_name(configurations[i + 1]) == series_name(c)) continue;
    PlotSeries series{fmt::format("{}, K = {}", series_name(c), c.num_previous_views), {}, c.times.mean_view_wall_s};
    for (std::size_t v = 0; v < series.y.size(); ++v) series.x.push_back(static_cast<double>(v));
    plot.series.push_back(std::move(series));
  }
  return format_svg(plot);
}

bool is_run_of(const EvaluatedRun& run, const ConfigurationSummary& c) {
  return run.preset == c.preset && run.num_previous_views == c.num_previous_views && run.is_clustered == c.is_clustered;
}

// Paper, Fig. 7. The figure shows a single sequence: here the longest one, the first by name among equals.
std::string find_longest_sequence(std::span<const EvaluatedRun> runs) {
  const EvaluatedRun* longest = nullptr;
  for (const EvaluatedRun& run : runs)
    if (longest == nullptr || run.views.size() > longest->views.size() ||
        (run.views.size() == longest->views.size() && run.sequence < longest->sequence))
      longest = &run;
  return longest == nullptr ? std::string() : longest->sequence;
}

PlotSeries verification_series(const EvaluatedRun& run, const std::string& name) {
  PlotSeries series{name, {}, {}};
  for (std::size_t v = 0; v < run.views.size(); ++v) {
    double wall_s = 0;
    for (const StageTime& stage : run.views[v].times.stages())
      if (stage.stage == "verification") wall_s += stage.wall_s;
    series.x.push_back(static_cast<double>(v));
    series.y.push_back(wall_s);
  }
  return series;
}

std::string plot_verification_times(std::span<const ConfigurationSummary> configurations,
                                    std::span<const EvaluatedRun> runs) {
  const std::string sequence = find_longest_sequence(runs);
  LinePlot plot{"Verification time, sequence " + sequence, "view", "seconds", {}, {}, {}};
  for (std::size_t i = 0; i < configurations.size(); ++i) {
    const ConfigurationSummary& c = configurations[i];
    if (i + 1 < configurations.size() && series_name(configurations[i + 1]) == series_name(c)) continue;
    for (const EvaluatedRun& run : runs)
      if (run.sequence == sequence && is_run_of(run, c))
        plot.series.push_back(
            verification_series(run, fmt::format("{}, K = {}", series_name(c), c.num_previous_views)));
  }
  return format_svg(plot);
}

}  // namespace

Result<void> write_evaluation(const std::filesystem::path& directory, const EvaluationHeader& header,
                              std::span<const EvaluatedRun> runs, int num_pictures) {
  const std::vector<ConfigurationSummary> c = summarize_runs(runs);
  using C = ConfigurationSummary;
  const std::pair<const char*, std::string> files[] = {
      {"results.json", format_evaluation_json(header, c)},
      {"times.json", format_evaluation_times_json(header, c)},
      {"tables.md", format_evaluation_tables(header, c, compare_presets(runs))},
      {"times.md", format_evaluation_times(header, c)},
      {"worst.md", format_worst_views(find_worst_views(runs), num_pictures)},
      {"precision.svg", plot_over_k(
                            "Precision", "precision", c, [](const C& x) { return x.score.precision(); }, true)},
      {"recall.svg", plot_over_k(
                         "Recall", "recall", c, [](const C& x) { return x.score.recall(); }, true)},
      {"f.svg", plot_over_k(
                    "F", "F", c, [](const C& x) { return x.score.f_score(); }, true)},
      {"ghosts.svg", plot_over_k(
                         "Ghost detections", "views per former place", c,
                         [](const C& x) { return x.ghosts.per_former_place(); }, false)},
      {"view_time.svg", plot_view_times(c)},
      {"verification_time.svg", plot_verification_times(c, runs)},
      {"verification_times.csv", format_verification_times(runs)}};
  for (const auto& [name, text] : files)
    if (auto written = write_file(directory / name, text); !written.ok()) return written;
  return {};
}

}  // namespace resight
