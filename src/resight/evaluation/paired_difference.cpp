// SPDX-License-Identifier: Apache-2.0
#include "resight/evaluation/paired_difference.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "resight/core/check.hpp"

namespace resight {
namespace {

constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

struct RunScores {
  RecognitionScore score, strict_score;
  double ghosts_per_change = kUnknown;
  double event_f_score = kUnknown;
  double log_cpu = kUnknown;
};

RunScores scores_of(const EvaluatedRun& run) {
  RunScores scores;
  double cpu_s = 0;
  for (const EvaluatedView& view : run.views) {
    scores.score += view.score;
    scores.strict_score += view.strict_score;
    for (const StageTime& stage : view.times.stages()) cpu_s += stage.cpu_s;
  }
  if (cpu_s > 0) scores.log_cpu = std::log(cpu_s);
  if (run.has_changes) scores.event_f_score = run.events.events.f_score();
  if (run.num_former_places > 0)
    scores.ghosts_per_change = static_cast<double>(run.num_ghosts()) / run.num_former_places;
  return scores;
}

const EvaluatedRun* find_run(std::span<const EvaluatedRun> runs, const std::string& preset, int k,
                             const std::string& sequence) {
  const auto found = std::ranges::find_if(runs, [&](const EvaluatedRun& run) {
    return run.is_clustered && run.preset == preset && run.num_previous_views == k && run.sequence == sequence;
  });
  return found == runs.end() ? nullptr : &*found;
}

RecognitionScore sum_scores(const std::vector<RunScores>& runs) {
  RecognitionScore sum;
  for (const RunScores& run : runs) sum += run.score;
  return sum;
}

template <typename Value>
PairedDifference compare(const std::vector<RunScores>& a, const std::vector<RunScores>& b, Value&& value) {
  std::vector<double> values_a, values_b;
  for (std::size_t i = 0; i < a.size(); ++i) {
    values_a.push_back(value(a[i]));
    values_b.push_back(value(b[i]));
  }
  return paired_difference(values_a, values_b);
}

}  // namespace

PairedDifference paired_difference(std::span<const double> a, std::span<const double> b) {
  require(a.size() == b.size(), "paired_difference: a and b differ in length");
  std::vector<double> differences;
  for (std::size_t i = 0; i < a.size(); ++i)
    if (!std::isnan(a[i]) && !std::isnan(b[i])) differences.push_back(b[i] - a[i]);
  PairedDifference result{static_cast<int>(differences.size()), kUnknown, kUnknown};
  if (differences.empty()) return result;
  const auto n = static_cast<double>(differences.size());
  double sum = 0;
  for (const double d : differences) sum += d;
  result.mean = sum / n;
  if (differences.size() < 2) return result;
  double squares = 0;
  for (const double d : differences) squares += (d - result.mean) * (d - result.mean);
  result.standard_error = std::sqrt(squares / (n - 1) / n);
  return result;
}

std::vector<PresetComparison> compare_presets(std::span<const EvaluatedRun> runs) {
  std::vector<std::string> presets;
  std::set<int> ks;
  std::set<std::string> sequences;
  for (const EvaluatedRun& run : runs) {
    if (std::ranges::find(presets, run.preset) == presets.end()) presets.push_back(run.preset);
    ks.insert(run.num_previous_views);
    sequences.insert(run.sequence);
  }
  std::vector<PresetComparison> comparisons;
  for (std::size_t p = 1; p < presets.size(); ++p)
    for (const int k : ks) {
      std::vector<RunScores> a, b;
      for (const std::string& sequence : sequences) {
        const EvaluatedRun* run_a = find_run(runs, presets[0], k, sequence);
        const EvaluatedRun* run_b = find_run(runs, presets[p], k, sequence);
        if (run_a == nullptr || run_b == nullptr) continue;
        a.push_back(scores_of(*run_a));
        b.push_back(scores_of(*run_b));
      }
      if (a.empty()) continue;
      comparisons.push_back({presets[0], presets[p], k, static_cast<int>(a.size()),
                             compare(a, b, [](const RunScores& s) { return s.score.precision(); }),
                             compare(a, b, [](const RunScores& s) { return s.score.recall(); }),
                             compare(a, b, [](const RunScores& s) { return s.score.f_score(); }),
                             compare(a, b, [](const RunScores& s) { return s.strict_score.f_score(); }),
                             compare(a, b, [](const RunScores& s) { return s.ghosts_per_change; }),
                             compare(a, b, [](const RunScores& s) { return s.event_f_score; }),
                             compare(a, b, [](const RunScores& s) { return s.log_cpu; }), sum_scores(a),
                             sum_scores(b)});
    }
  return comparisons;
}

}  // namespace resight
