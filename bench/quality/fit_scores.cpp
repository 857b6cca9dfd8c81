// SPDX-License-Identifier: Apache-2.0
// Fits the weights of the scores of detections (HypothesisScoreOptions) that a preset uses: right or wrong at K = 0
// and 5. Groups of sequences are divided by "--" and count the same. The calibration error of a group is that of scores
// whose weights were fitted without the sequence, and so is the log loss. Those of the preset itself are beside them.
//   bench_fit_scores default val.resight val/test/000001 val.resight val/test/000002 -- tc.resight
//   table-camera/test/000001
#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "arguments.hpp"
#include "resight/evaluation/match_detections.hpp"
#include "resight/evaluation/reliability.hpp"
#include "resight/io/sequence.hpp"
#include "resight/models/library_file.hpp"
#include "resight/recognition/recognize_sequence.hpp"
#include "resight/report/view_record.hpp"

namespace {

using namespace resight;

constexpr int kNumWeights = std::tuple_size_v<ScoreCues> + 1;  // With the offset.
using Weights = Eigen::Matrix<double, kNumWeights, 1>;
constexpr const char* kNames[kNumWeights] = {"gain",          "correspondence", "fit",          "visible",    "texture",
                                             "beside planes", "newest",         "seen through", "silhouette", "offset"};

struct Sample {
  Weights cues;
  double score = 0;  // Of the preset.
  bool right = false;
  int group = 0;
  int sequence = 0;
};

void add_samples(const char* library_path, const char* path, RecognizerConfig config, int group, int number,
                 std::vector<Sample>& samples) {
  const auto sequence = open_or_exit(path);
  const ModelLibrary library = value_or_exit(load_library(library_path));
  SceneRecognizer recognizer(library, std::move(config));
  RecognitionTrace trace;
  const auto add_view = [&](const RgbdFrame& /*frame*/, const SceneUpdate& update) {
    const auto truth = value_or_exit(sequence->read_ground_truth(update.view));
    const auto matched = match_detections(truth, to_detected_objects(update, library), library, {});
    const auto add = [&](int d, bool right) {
      const Detection& detection = update.detections[d];
      const ScoreCues cues = score_cues(trace.evidence_of(detection.hypothesis_id));
      Sample& sample = samples.emplace_back(Sample{Weights::Ones(), detection.score, right, group, number});
      std::ranges::copy(cues, sample.cues.data());
    };
    for (const DetectionMatch& m : matched.matches) add(m.detection, true);
    for (const int d : matched.false_positives) add(d, false);
  };
  (void)value_or_exit(recognize_sequence(recognizer, *sequence, add_view, &trace));
}

double probability(const Weights& weights, const Weights& cues) { return 1 / (1 + std::exp(-weights.dot(cues))); }

double log_loss(double score, bool right) { return -std::log(std::clamp(right ? score : 1 - score, 1e-9, 1.0)); }

// Logistic regression by Newton's method, with a little ridge. `is_used`: cues that count. Leaves out a sequence.
Weights fit(const std::vector<Sample>& samples, const Weights& is_used, int left_out) {
  std::vector<double> num_in_group;
  for (const Sample& s : samples) {
    num_in_group.resize(std::max<std::size_t>(num_in_group.size(), s.group + 1));
    if (s.sequence != left_out) ++num_in_group[s.group];
  }
  Weights weights = Weights::Zero();
  for (int i = 0; i < 50; ++i) {
    Eigen::Matrix<double, kNumWeights, kNumWeights> h = Eigen::Matrix<double, kNumWeights, kNumWeights>::Identity();
    h *= 1e-6;
    Weights g = -1e-6 * weights;
    for (const Sample& s : samples) {
      if (s.sequence == left_out) continue;
      const Weights cues = s.cues.cwiseProduct(is_used);
      const double p = probability(weights, cues);
      const double count = 1 / num_in_group[s.group];
      h += count * p * (1 - p) * cues * cues.transpose();
      g += count * ((s.right ? 1 : 0) - p) * cues;
    }
    weights += h.ldlt().solve(g);
  }
  return weights;
}

void print_calibration(const std::vector<Sample>& samples, const Weights& is_used, int num_sequences, int num_groups) {
  std::vector<Reliability> fitted(num_groups), current(num_groups);
  std::vector<double> fitted_loss(num_groups), current_loss(num_groups), num_samples(num_groups);
  for (int left_out = 0; left_out < num_sequences; ++left_out) {
    const Weights weights = fit(samples, is_used, left_out);
    for (const Sample& s : samples) {
      if (s.sequence != left_out) continue;
      const double score = probability(weights, s.cues.cwiseProduct(is_used));
      fitted[s.group].add(score, s.right);
      current[s.group].add(s.score, s.right);
      fitted_loss[s.group] += log_loss(score, s.right);
      current_loss[s.group] += log_loss(s.score, s.right);
      ++num_samples[s.group];
    }
  }
  for (int g = 0; g < num_groups; ++g)
    fmt::print(
        "group {}: calibration error {:.3f} and log loss {:.4f} fitted without the sequence, {:.3f} and {:.4f} as the "
        "preset has it\n",
        g + 1, fitted[g].calibration_error(), fitted_loss[g] / num_samples[g], current[g].calibration_error(),
        current_loss[g] / num_samples[g]);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 4)
    exit_with("usage: bench_fit_scores PRESET LIBRARY SEQUENCE [LIBRARY SEQUENCE]... [-- LIBRARY SEQUENCE...]");
  RecognizerConfig config = preset_or_exit(argv[1]);
  config.set_num_threads(2);
  config.detections.min_score = 0;
  const HypothesisScoreOptions& score = config.verify.score;
  Weights is_used;
  is_used << score.gain_weight, score.correspondence_weight, score.fit_weight, score.visible_weight,
      score.texture_weight, score.beside_planes_weight, score.newest_weight, score.seen_through_weight,
      score.silhouette_weight, 1;
  is_used = (is_used.array() != 0).cast<double>();
  std::vector<Sample> samples;
  int group = 0, number = 0;
  for (int a = 2; a + 1 < argc; a += 2) {
    if (std::string(argv[a]) == "--") ++group, ++a;
    for (const int num_previous_views : {0, 5}) {
      config.num_previous_views = num_previous_views;
      add_samples(argv[a], argv[a + 1], config, group, number, samples);
    }
    ++number;
  }
  const Weights weights = fit(samples, is_used, -1);
  for (int c = 0; c < kNumWeights; ++c) fmt::print("{} {:.2f}\n", kNames[c], weights[c]);
  print_calibration(samples, is_used, number, group + 1);
  return 0;
}
