// SPDX-License-Identifier: Apache-2.0
#include "resight/evaluation/evaluation_summary.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <tuple>

namespace resight {
namespace {

constexpr std::array kBins{0.05, 0.2, 0.4, 0.6, 0.8};
constexpr double kUndefined = std::numeric_limits<double>::quiet_NaN();

std::size_t bin_of(double visible_share) {
  if (std::isnan(visible_share)) return kBins.size();
  std::size_t bin = 0;
  while (bin + 1 < kBins.size() && visible_share >= kBins[bin + 1]) ++bin;
  return bin;
}

double nearest_rank(const std::vector<double>& sorted, double share) {
  if (sorted.empty()) return kUndefined;
  const auto rank = static_cast<std::size_t>(std::ceil(share * static_cast<double>(sorted.size())));
  return sorted[std::max<std::size_t>(rank, 1) - 1];
}

// Accumulates the runs of one configuration.
class Summarizer {
 public:
  explicit Summarizer(const EvaluatedRun& first) {
    summary_.preset = first.preset;
    summary_.num_previous_views = first.num_previous_views;
    summary_.is_clustered = first.is_clustered;
    summary_.found.by_visible_share.resize(kBins.size() + 1);
  }

  void add(const EvaluatedRun& run) {
    ++summary_.num_sequences;
    summary_.ghosts.num_detections += run.num_ghosts();
    summary_.ghosts.num_former_places += run.num_former_places;
    summary_.ghosts.num_published_places += run.num_published_places;
    summary_.changes.are_scored |= run.has_changes;
    summary_.changes.events += run.events;
    summary_.times.num_threads.insert(run.num_threads);
    for (std::size_t v = 0; v < run.views.size(); ++v) add_view(v, run.views[v]);
  }

  ConfigurationSummary finish() {
    summary_.errors.center_m = error_quantiles(std::move(center_errors_m_));
    summary_.errors.rotation_rad = error_quantiles(std::move(rotation_errors_rad_));
    for (std::size_t v = 0; v < wall_s_.size(); ++v)
      summary_.times.mean_view_wall_s.push_back(wall_s_[v] / num_with_view_[v]);
    return std::move(summary_);
  }

 private:
  void add_view(std::size_t number, const EvaluatedView& view) {
    ++summary_.num_views;
    summary_.score += view.score;
    summary_.strict_score += view.strict_score;
    summary_.ghosts.num_by_published_rule += view.num_detected_former_places;
    summary_.counts.correspondences += view.counts.correspondences;
    summary_.counts.generated += view.counts.generated;
    summary_.counts.merged += view.counts.merged;
    summary_.counts.clustered += view.counts.clustered;
    summary_.counts.accepted += view.counts.accepted;
    summary_.changes.points.removed += view.points.removed;
    summary_.changes.points.novel += view.points.novel;
    summary_.times.stages.add(view.times);
    if (wall_s_.size() <= number) {
      wall_s_.resize(number + 1);
      num_with_view_.resize(number + 1);
    }
    wall_s_[number] += view.times.total_wall_s();
    ++num_with_view_[number];
    for (const EvaluatedTruth& t : view.truth)
      if (t.counts) add_truth(t);
    for (const EvaluatedDetection& d : view.detections) {
      if (d.verdict == DetectionVerdict::kIgnored) continue;
      const bool is_right = d.verdict == DetectionVerdict::kCorrect;
      summary_.reliability.add(d.score, is_right);
      if (!is_right) ++summary_.found.by_object[d.object].false_positives;
    }
  }

  void add_truth(const EvaluatedTruth& t) {
    for (FoundCount* count :
         {&summary_.found.by_object[t.object], &summary_.found.by_visible_share[bin_of(t.visible_share)]}) {
      ++(t.found ? count->found : count->missed);
      if (!t.lost_at.empty()) ++count->lost_at[t.lost_at];
    }
    if (!t.lost_at.empty()) ++summary_.found.lost_at[t.lost_at];
    if (!t.found) return;
    center_errors_m_.push_back(t.center_error_m);
    rotation_errors_rad_.push_back(t.rotation_error_rad);
  }

  ConfigurationSummary summary_;
  std::vector<double> center_errors_m_, rotation_errors_rad_;
  std::vector<double> wall_s_;
  std::vector<int> num_with_view_;
};

bool is_of(const EvaluatedRun& run, const EvaluatedRun& other) {
  return run.preset == other.preset && run.num_previous_views == other.num_previous_views &&
         run.is_clustered == other.is_clustered;
}

}  // namespace

std::span<const double> visible_share_bins() { return kBins; }

ErrorQuantiles error_quantiles(std::vector<double> values) {
  std::ranges::sort(values);
  return {static_cast<int>(values.size()), nearest_rank(values, 0.5), nearest_rank(values, 0.95)};
}

double GhostSummary::per_former_place() const {
  return num_former_places == 0 ? kUndefined : static_cast<double>(num_detections) / num_former_places;
}

std::vector<ConfigurationSummary> summarize_runs(std::span<const EvaluatedRun> runs) {
  std::vector<std::string> presets;
  std::vector<const EvaluatedRun*> ordered;
  for (const EvaluatedRun& run : runs) {
    if (std::ranges::find(presets, run.preset) == presets.end()) presets.push_back(run.preset);
    ordered.push_back(&run);
  }
  const auto rank = [&](const EvaluatedRun* run) {
    return std::make_tuple(std::ranges::find(presets, run->preset) - presets.begin(), !run->is_clustered,
                           run->num_previous_views, std::string_view(run->sequence));
  };
  std::ranges::sort(ordered, {}, rank);
  std::vector<ConfigurationSummary> summaries;
  for (std::size_t i = 0; i < ordered.size();) {
    Summarizer summarizer(*ordered[i]);
    const std::size_t first = i;
    for (; i < ordered.size() && is_of(*ordered[i], *ordered[first]); ++i) summarizer.add(*ordered[i]);
    summaries.push_back(summarizer.finish());
  }
  return summaries;
}

}  // namespace resight
