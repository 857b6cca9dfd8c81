// SPDX-License-Identifier: Apache-2.0
// Results of the presets mvr and mvr-chd with the values of the paper and its reference code where ours differ
// (docs/paper-to-code.md), one by one and together. Features and hypotheses are computed once.
//   resight simulate --preset demo --seed 3 --format bop --out scene; resight train scene/models --out models.resight
//   bench_paper_switches scene models.resight
#include <fmt/format.h>

#include <cstdio>
#include <functional>
#include <memory>

#include "arguments.hpp"
#include "resight/evaluation/evaluate_sequence.hpp"
#include "resight/evaluation/evaluation_summary.hpp"
#include "resight/io/sequence.hpp"
#include "resight/models/library_file.hpp"
#include "resight/recognition/recognizer_config.hpp"

namespace {

using namespace resight;

struct Switch {
  const char* name;
  std::function<void(RecognizerConfig&)> set;
};

void set_duplicity(RecognizerConfig& c) { c.verify.selection.duplicity_rule = DuplicityRule::kAllWeights; }
void set_seen_through(RecognizerConfig& c) { c.verify.visibility.free_space = MajorityFreeSpace{.max_share = 1}; }
void set_planes(RecognizerConfig& c) { c.verify.planes->max_distance_m = 0.02; }
void set_shares(RecognizerConfig& c) {
  c.verify.acceptance.min_visible_share = c.verify.acceptance.min_explained_share = 0;
}
void set_novel(RecognizerConfig& c) {
  std::get<PointTestOptions>(c.changes.detection.test).novel_needs_free_space = false;
}

const Switch kSwitches[] = {
    {"as it is", [](RecognizerConfig&) {}},
    {"duplicity: all weights", set_duplicity},
    {"seen through: no limit", set_seen_through},
    {"planes: 2 cm", set_planes},
    {"shares: no limits", set_shares},
    {"these four", [](RecognizerConfig& c) { set_duplicity(c), set_seen_through(c), set_planes(c), set_shares(c); }},
    {"novel by Eq. 3 alone", set_novel},
    {"colour sigmas 0.6",
     [](RecognizerConfig& c) { c.verify.appearance.sigma_l = c.verify.appearance.sigma_ab = 0.6; }},
    {"no clustering", [](RecognizerConfig& c) { c.hypotheses.cluster.reset(); }},
};

double cpu_ms(const StageTimes& times, std::string_view stage, int num_views) {
  for (const StageTime& time : times.stages())
    if (time.stage == stage) return 1e3 * time.cpu_s / num_views;
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) {
    fmt::print(stderr, "usage: bench_paper_switches SEQUENCE LIBRARY\n");
    return 2;
  }
  const auto sequence = value_or_exit(open_sequence(argv[1]));
  const ModelLibrary library = value_or_exit(load_library(argv[2]));
  const SequenceTruth truth = value_or_exit(read_sequence_truth(*sequence, library));
  EvaluateSequenceOptions options;
  options.find_losses = false;
  options.hypotheses = std::make_shared<ViewHypothesisStore>();
  fmt::print(
      "| preset | | P | R | F | TP | FP | FN | ghosts | kept by clustering | cluster, verify: CPU ms per view |\n");
  for (const char* preset : {"mvr-chd", "mvr"})
    for (const Switch& change : kSwitches) {
      RecognizerConfig config = RecognizerConfig::from_preset(preset);
      change.set(config);
      const EvaluatedRun run = value_or_exit(evaluate_sequence(*sequence, truth, library, config, options));
      const ConfigurationSummary s = summarize_runs(std::span(&run, 1)).front();
      fmt::print("| {} | {} | {:.3f} | {:.3f} | {:.3f} | {} | {} | {} | {} | {:.0f} % | {:.1f}, {:.0f} |\n", preset,
                 change.name, s.score.precision(), s.score.recall(), s.score.f_score(), s.score.true_positives,
                 s.score.false_positives, s.score.false_negatives, s.ghosts.num_detections,
                 100.0 * s.counts.clustered / std::max(1, s.counts.merged),
                 cpu_ms(s.times.stages, "cluster", s.num_views), cpu_ms(s.times.stages, "verification", s.num_views));
      std::fflush(stdout);
    }
  return 0;
}
