// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <set>

#include "resight/evaluation/loss.hpp"
#include "resight/report/evaluation_report.hpp"
#include "resight/report/internal/evaluation_text.hpp"
#include "resight/report/internal/markdown.hpp"

namespace resight {
namespace {

using report::ClusteringPair;
using report::configuration_name;
using report::evaluation_title;
using report::find_clustering_pairs;
using report::format_number;
using Configurations = std::span<const ConfigurationSummary>;

constexpr double kDegrees = 180 / std::numbers::pi;

// Share with three decimals; "-" for NaN.
std::string share(double value) { return format_number(value, 3); }
std::string prf(const RecognitionScore& s) {
  return fmt::format("{} | {} | {}", share(s.precision()), share(s.recall()), share(s.f_score()));
}
std::string recognition_table(Configurations configurations) {
  std::string text =
      "## Recognition over K\n\n"
      "| preset | K | precision | recall | F | strict precision | strict recall | strict F | centre median | "
      "centre 95 % | rotation median | rotation 95 % | ghosts | per former place | by the published rule |\n"
      "|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|\n";
  for (const ConfigurationSummary& c : configurations)
    text += fmt::format("| {} | {} | {} | {} | {} mm | {} mm | {} deg | {} deg | {} | {} | {} |\n",
                        configuration_name(c), c.num_previous_views, prf(c.score), prf(c.strict_score),
                        format_number(1e3 * c.errors.center_m.median, 1), format_number(1e3 * c.errors.center_m.p95, 1),
                        format_number(kDegrees * c.errors.rotation_rad.median, 1),
                        format_number(kDegrees * c.errors.rotation_rad.p95, 1), c.ghosts.num_detections,
                        format_number(c.ghosts.per_former_place(), 2), c.ghosts.num_by_published_rule);
  return text;
}

std::string difference(const PairedDifference& d, int digits) {
  if (std::isnan(d.mean)) return "-";
  return fmt::format("{:+.{}f} ± {}", d.mean, digits, format_number(d.standard_error, digits));
}

std::string comparison_table(std::span<const PresetComparison> comparisons) {
  if (comparisons.empty()) return {};
  std::string text =
      "\n## Differences between presets\n\nMean difference over the sequences, and its standard error.\n\n"
      "| presets | K | sequences | precision | recall | F | strict F | ghosts per former place |\n"
      "|---|---|---|---|---|---|---|---|\n";
  for (const PresetComparison& c : comparisons)
    text += fmt::format("| `{}` - `{}` | {} | {} | {} | {} | {} | {} | {} |\n", c.b, c.a, c.num_previous_views,
                        c.num_sequences, difference(c.precision, 3), difference(c.recall, 3), difference(c.f_score, 3),
                        difference(c.strict_f_score, 3), difference(c.ghosts_per_change, 2));
  return text;
}

std::string clustering_table(Configurations configurations) {
  std::string rows;
  for (const ClusteringPair& pair : find_clustering_pairs(configurations)) {
    rows += fmt::format("| `{}` | {} | {} | {} | {} | {} | {} % |\n", pair.with->preset, pair.with->num_previous_views,
                        prf(pair.without->score), prf(pair.with->score), pair.without->counts.clustered,
                        pair.with->counts.clustered,
                        format_number(100.0 * pair.with->counts.clustered / std::max(1, pair.with->counts.merged), 1));
  }
  if (rows.empty()) return {};
  return "\n## Clustering (Tables II and III)\n\n"
         "| preset | K | precision without | recall without | F without | precision | recall | F | hypotheses "
         "without | with | kept |\n|---|---|---|---|---|---|---|---|---|---|---|\n" +
         rows;
}

std::string bin_name(std::span<const ScoreBin> bins, std::size_t b) {
  const double to = b + 1 < bins.size() ? bins[b + 1].from : 1;
  return fmt::format("{:.2f} to {:.2f}", bins[b].from, to);
}

std::string bin_cell(const ScoreBin& bin) {
  return bin.count() == 0 ? "-"
                          : fmt::format("{} / {} ({})", share(bin.mean_score()), share(bin.share_right()), bin.count());
}

std::string reliability_table(Configurations configurations) {
  if (configurations.empty()) return {};
  std::string header = "| preset | K | calibration error |";
  std::string rule = "|---|---|---|";
  const auto bins = configurations.front().reliability.bins();
  for (std::size_t b = 0; b < bins.size(); ++b) {
    header += fmt::format(" {} |", bin_name(bins, b));
    rule += "---|";
  }
  std::string rows;
  for (const ConfigurationSummary& c : configurations) {
    rows += fmt::format("| {} | {} | {} |", configuration_name(c), c.num_previous_views,
                        share(c.reliability.calibration_error()));
    for (const ScoreBin& bin : c.reliability.bins()) rows += fmt::format(" {} |", bin_cell(bin));
    rows += "\n";
  }
  return fmt::format("\n## Scores\n\nDetections by score: mean score / share that is right (count).\n\n{}\n{}\n{}",
                     header, rule, rows);
}

std::string points_cells(const ChangePointScore& s) {
  return fmt::format("{} | {}", share(s.precision()), share(s.recall()));
}

std::string change_table(Configurations configurations) {
  std::string rows;
  for (const ConfigurationSummary& c : configurations) {
    if (!c.changes.are_scored) continue;
    const auto& d = c.changes.events.delays;
    const double mean =
        d.empty() ? std::nan("") : std::accumulate(d.begin(), d.end(), 0.0) / static_cast<double>(d.size());
    const double late = d.empty() ? std::nan("")
                                  : static_cast<double>(std::ranges::count_if(d, [](int x) { return x > 1; })) /
                                        static_cast<double>(d.size());
    rows += fmt::format("| {} | {} | {} | {} | {} | {} | {} | {} | {} | {} | {} | {} |\n", configuration_name(c),
                        c.num_previous_views, points_cells(c.changes.points.removed),
                        points_cells(c.changes.points.novel), share(c.changes.events.events.precision()),
                        share(c.changes.events.events.recall()), format_number(mean, 2), share(late),
                        share(c.changes.events.departures.precision()), share(c.changes.events.departures.recall()),
                        share(c.changes.events.arrivals.precision()), share(c.changes.events.arrivals.recall()));
  }
  if (rows.empty()) return {};
  return "\n## Changes\n\nPoints of objects that have left (removed) or arrived (novel), and events: added, moved, "
         "removed, with their places. A departure is the former place of a removed or moved object, an arrival the new "
         "place of an added or moved one.\n\n"
         "| preset | K | removed precision | removed recall | novel precision | novel recall | event precision | event "
         "recall | mean delay (views) | later than one view | departure precision | departure recall | arrival "
         "precision | arrival recall |\n|---|---|---|---|---|---|---|---|---|---|---|---|---|---|\n" +
         rows;
}

std::string lost_cells(const std::map<std::string, int>& lost_at, const std::vector<std::string>& stages) {
  std::string text;
  for (const std::string& stage : stages) {
    const auto entry = lost_at.find(stage);
    text += fmt::format(" {} |", entry == lost_at.end() ? 0 : entry->second);
  }
  return text;
}

std::string loss_header(const std::string& first, const std::vector<std::string>& stages) {
  std::string text = first;
  std::string rule = "|";
  for (const char c : first) rule += c == '|' ? "---|" : "";
  for (const std::string& stage : stages) {
    text += " " + stage + " |";
    rule += "---|";
  }
  // The leading bar of `first` opens no column.
  return text + "\n" + rule.substr(0, rule.size() - 4) + "\n";
}

std::string loss_table(Configurations configurations, const std::vector<std::string>& stages) {
  std::string text = "\n## Where missed objects were lost\n\n";
  text += loss_header("| preset | K | missed |", stages);
  for (const ConfigurationSummary& c : configurations)
    text += fmt::format("| {} | {} | {} |{}\n", configuration_name(c), c.num_previous_views, c.score.false_negatives,
                        lost_cells(c.found.lost_at, stages));
  return text;
}

std::string found_row(const std::string& first, const FoundCount& count, const std::vector<std::string>& stages) {
  const int all = count.found + count.missed;
  return fmt::format("| {} | {} | {} | {} |{}\n", first, all,
                     share(all == 0 ? std::nan("") : static_cast<double>(count.found) / all), count.false_positives,
                     lost_cells(count.lost_at, stages));
}

std::string breakdown(const ConfigurationSummary& c, const std::vector<std::string>& stages) {
  std::string text =
      fmt::format("\n## {}, K = {}: objects and visibility\n\n", configuration_name(c), c.num_previous_views);
  text += loss_header("| object | instances | recall | false |", stages);
  for (const auto& [name, count] : c.found.by_object) text += found_row(report::escape_markdown(name), count, stages);
  text += '\n';
  text += loss_header("| visible share | instances | recall | false |", stages);
  const auto bins = visible_share_bins();
  for (std::size_t i = 0; i < c.found.by_visible_share.size(); ++i) {
    if (i == bins.size() && c.found.by_visible_share[i].found + c.found.by_visible_share[i].missed == 0) continue;
    const std::string name = i == bins.size()
                                 ? "unknown"
                                 : fmt::format("{:.2f} to {:.2f}", bins[i], i + 1 < bins.size() ? bins[i + 1] : 1.0);
    text += found_row(name, c.found.by_visible_share[i], stages);
  }
  return text;
}

// The stages that occur, in processing order.
std::vector<std::string> stages_of(Configurations configurations) {
  std::set<std::string> names;
  for (const ConfigurationSummary& c : configurations)
    for (const auto& [name, count] : c.found.lost_at) names.insert(name);
  std::vector<std::string> ordered;
  for (int stage = 0; stage <= static_cast<int>(LossStage::kRejected); ++stage)
    if (const char* known = to_string(static_cast<LossStage>(stage)); names.erase(known) > 0)
      ordered.emplace_back(known);
  ordered.insert(ordered.end(), names.begin(), names.end());
  return ordered;
}

}  // namespace

std::string format_evaluation_tables(const EvaluationHeader& header, Configurations configurations,
                                     std::span<const PresetComparison> comparisons) {
  const std::vector<std::string> stages = stages_of(configurations);
  std::string text =
      evaluation_title("Evaluation", header, configurations) +
      " Right: within 5 cm and 30 deg (strict: 1 cm and 10 deg) of an object that is at least 5 % visible. "
      "Ghost: an object reported at a place it has left.\n\n";
  text += recognition_table(configurations) + comparison_table(comparisons) + reliability_table(configurations) +
          clustering_table(configurations) + change_table(configurations);
  text += loss_table(configurations, stages);
  for (const ConfigurationSummary& c : configurations) text += breakdown(c, stages);
  return text;
}

}  // namespace resight
