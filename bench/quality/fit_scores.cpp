// SPDX-License-Identifier: Apache-2.0
// Fits the weights of the scores of detections (HypothesisScoreOptions) that a preset uses, and the odds of further
// instances: right or wrong at K = 0 and 5. Groups of sequences are divided by "--" and count the same. The calibration
// error of a group is that of scores whose weights were fitted without the sequence, and so is the log loss. Those of
// the preset itself are beside them. With only=, all other weights stay as the preset has them.
//   bench_fit_scores default val.resight val/test/000001 val.resight val/test/000002 -- tc.resight
//   table-camera/test/000001
#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <algorithm>
#include <bit>
#include <cmath>
#include <map>
#include <sstream>
#include <string>
#include <tuple>
#include <vector>

#include "arguments.hpp"
#include "resight/evaluation/match_detections.hpp"
#include "resight/evaluation/match_view.hpp"
#include "resight/evaluation/reliability.hpp"
#include "resight/models/library_file.hpp"
#include "resight/recognition/recognize_sequence.hpp"

namespace {

using namespace resight;

constexpr int kNumWeights = std::tuple_size_v<ScoreCues> + 2;  // With the offset and the log odds.
constexpr int kFurtherOdds = kNumWeights - 1;
constexpr std::size_t kMaxInstances = 10;  // Of an object in a view: 2^10 subsets.
using Weights = Eigen::Matrix<double, kNumWeights, 1>;
using Hessian = Eigen::Matrix<double, kNumWeights, kNumWeights>;
constexpr const char* kNames[kNumWeights] = {
    "gain",         "correspondence", "fit", "visible",   "texture", "beside_planes",   "newest",
    "seen_through", "silhouette",     "hue", "uncolored", "offset",  "log_further_odds"};

// What the fit starts from, and the weights that it changes.
struct Fit {
  Weights start = Weights::Zero();
  Weights is_free = Weights::Zero();  // 0 or 1.
};

struct Sample {
  Weights cues;      // 0 for the odds of further instances.
  double score = 0;  // Of the preset.
  bool right = false;
};

// The detections of one object in one view. Any subset of them can be right (instance_prior.hpp).
struct SampleSet {
  std::vector<Sample> samples;
  int group = 0;
  int sequence = 0;
  Eigen::Matrix<double, kNumWeights, Eigen::Dynamic> cues_of_subset{};  // Sums; the log of its probability is linear.
  unsigned right_subset = 0;

  void sum_over_subsets() {
    const std::size_t n = samples.size();
    cues_of_subset.setZero(kNumWeights, 1 << n);
    for (std::size_t i = 0; i < n; ++i) right_subset |= samples[i].right ? 1U << i : 0;
    for (unsigned subset = 0; subset < 1U << n; ++subset) {
      for (std::size_t i = 0; i < n; ++i)
        if ((subset >> i & 1U) != 0) cues_of_subset.col(subset) += samples[i].cues;
      cues_of_subset(kFurtherOdds, subset) = std::max(0, std::popcount(subset) - 1);
    }
  }
  [[nodiscard]] Eigen::VectorXd subset_probabilities(const Weights& weights) const {
    const Eigen::VectorXd log_odds = cues_of_subset.transpose() * weights;
    const Eigen::VectorXd odds = (log_odds.array() - log_odds.maxCoeff()).exp();
    return odds / odds.sum();
  }
};

void add_samples(const char* library_path, const char* path, RecognizerConfig config, int group, int number,
                 std::vector<SampleSet>& sets) {
  const auto sequence = open_or_exit(path);
  const ModelLibrary library = value_or_exit(load_library(library_path));
  SceneRecognizer recognizer(library, std::move(config));
  RecognitionTrace trace;
  const auto add_view = [&](const RgbdFrame& frame, const SceneUpdate& update) {
    const TruthView truth{update.world_from_camera, value_or_exit(sequence->read_ground_truth(update.view))};
    const auto matched =
        match_view(update.view, truth, to_detected_objects(update, library), {}, frame.camera, library).loose;
    std::map<int, SampleSet> by_object;
    const auto add = [&](int d, bool right) {
      const Detection& detection = update.detections[d];
      const ScoreCues cues = score_cues(trace.evidence_of(detection.hypothesis_id));
      Sample sample{Weights::Zero(), detection.score, right};
      std::ranges::copy(cues, sample.cues.data());
      sample.cues[cues.size()] = 1;
      SampleSet& set = by_object.try_emplace(detection.object, SampleSet{{}, group, number}).first->second;
      if (set.samples.size() < kMaxInstances) set.samples.push_back(sample);
    };
    for (const DetectionMatch& m : matched.matches) add(m.detection, true);
    for (const int d : matched.false_positives) add(d, false);
    for (auto& [object, set] : by_object) {
      set.sum_over_subsets();
      sets.push_back(std::move(set));
    }
  };
  (void)value_or_exit(recognize_sequence(recognizer, *sequence, add_view, &trace));
}

double probability_of_sample(const Eigen::VectorXd& subset_probabilities, std::size_t sample) {
  double sum = 0;
  for (unsigned subset = 0; subset < subset_probabilities.size(); ++subset)
    if ((subset >> sample & 1U) != 0) sum += subset_probabilities[subset];
  return sum;
}

double log_loss(double score, bool right) { return -std::log(std::clamp(right ? score : 1 - score, 1e-9, 1.0)); }

// The likeliest weights by Newton's method, with a little ridge. Leaves out a sequence.
Weights fit_weights(const std::vector<SampleSet>& sets, const Fit& fit, int left_out) {
  std::vector<double> num_in_group;
  for (const SampleSet& s : sets) {
    num_in_group.resize(std::max<std::size_t>(num_in_group.size(), s.group + 1));
    if (s.sequence != left_out) num_in_group[s.group] += static_cast<double>(s.samples.size());
  }
  Weights weights = fit.start;
  for (int i = 0; i < 50; ++i) {
    Hessian h = Hessian::Zero();
    Weights g = -1e-6 * (weights - fit.start);
    for (const SampleSet& s : sets) {
      if (s.sequence == left_out) continue;
      const Eigen::VectorXd probabilities = s.subset_probabilities(weights);
      const Weights mean = s.cues_of_subset * probabilities;
      const auto centered = (s.cues_of_subset.colwise() - mean).eval();
      const double count = 1 / num_in_group[s.group];
      h += count * centered * probabilities.asDiagonal() * centered.transpose();
      g += count * (s.cues_of_subset.col(s.right_subset) - mean);
    }
    h = fit.is_free.asDiagonal() * h * fit.is_free.asDiagonal();
    h += 1e-6 * Hessian::Identity();
    weights += h.ldlt().solve(fit.is_free.cwiseProduct(g));
  }
  return weights;
}

void print_calibration(const std::vector<SampleSet>& sets, const Fit& fit, int num_sequences, int num_groups) {
  std::vector<Reliability> fitted(num_groups), current(num_groups);
  std::vector<double> fitted_loss(num_groups), current_loss(num_groups), num_samples(num_groups);
  for (int left_out = 0; left_out < num_sequences; ++left_out) {
    const Weights weights = fit_weights(sets, fit, left_out);
    for (const SampleSet& s : sets) {
      if (s.sequence != left_out) continue;
      const Eigen::VectorXd probabilities = s.subset_probabilities(weights);
      for (std::size_t i = 0; i < s.samples.size(); ++i) {
        const Sample& sample = s.samples[i];
        const double score = probability_of_sample(probabilities, i);
        fitted[s.group].add(score, sample.right);
        current[s.group].add(sample.score, sample.right);
        fitted_loss[s.group] += log_loss(score, sample.right);
        current_loss[s.group] += log_loss(sample.score, sample.right);
        ++num_samples[s.group];
      }
    }
  }
  for (int g = 0; g < num_groups; ++g)
    fmt::print(
        "group {}: calibration error {:.3f} and log loss {:.4f} fitted without the sequence, {:.3f} and {:.4f} as the "
        "preset has it\n",
        g + 1, fitted[g].calibration_error(), fitted_loss[g] / num_samples[g], current[g].calibration_error(),
        current_loss[g] / num_samples[g]);
}

// All weights that the preset uses, from nothing; or those of "only=NAME,...", with the others as the preset has them.
Fit what_to_fit(const RecognizerConfig& config, const std::string& only) {
  const HypothesisScoreOptions& score = config.verify.score;
  Weights preset;
  preset << score.gain_weight, score.correspondence_weight, score.fit_weight, score.visible_weight,
      score.texture_weight, score.beside_planes_weight, score.newest_weight, score.seen_through_weight,
      score.silhouette_weight, score.hue_weight, score.uncolored_weight, score.offset,
      std::log(config.detections.further_instance_odds);
  Fit fit;
  if (only.empty()) {
    fit.is_free = (preset.array() != 0).cast<double>();
    return fit;
  }
  fit.start = preset;
  std::istringstream names(only);
  for (std::string name; std::getline(names, name, ',');) {
    const auto* const found = std::ranges::find(kNames, name);
    if (found == std::end(kNames)) exit_with(fmt::format("there is no weight '{}'", name));
    fit.is_free[found - std::begin(kNames)] = 1;
  }
  return fit;
}

}  // namespace

int main(int argc, char** argv) {
  const std::string only = argc > 2 && std::string(argv[2]).starts_with("only=") ? std::string(argv[2] + 5) : "";
  const int first = only.empty() ? 2 : 3;
  if (argc < first + 2)
    exit_with("usage: bench_fit_scores PRESET [only=WEIGHT,...] LIBRARY SEQUENCE... [-- LIBRARY SEQUENCE...]");
  RecognizerConfig config = preset_or_exit(argv[1]);
  config.set_num_threads(2);
  config.detections.min_score = 0;
  const Fit fit = what_to_fit(config, only);
  std::vector<SampleSet> sets;
  int group = 0, number = 0;
  for (int a = first; a + 1 < argc; a += 2) {
    if (std::string(argv[a]) == "--") ++group, ++a;
    for (const int num_previous_views : {0, 5}) {
      config.num_previous_views = num_previous_views;
      add_samples(argv[a], argv[a + 1], config, group, number, sets);
    }
    ++number;
  }
  const Weights weights = fit_weights(sets, fit, -1);
  for (int c = 0; c < kNumWeights; ++c) fmt::print("{} {:.2f}\n", kNames[c], weights[c]);
  print_calibration(sets, fit, number, group + 1);
  return 0;
}
