// SPDX-License-Identifier: Apache-2.0
#include "resight/evaluation/paired_difference.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

namespace resight {
namespace {

TEST(PairedDifference, MeanAndItsError) {
  // Differences 1, 2, 6: mean 3, sample variance (4 + 1 + 9) / 2 = 7.
  const PairedDifference d = paired_difference(std::vector{10.0, 20.0, 30.0}, std::vector{11.0, 22.0, 36.0});
  EXPECT_EQ(d.num_pairs, 3);
  EXPECT_DOUBLE_EQ(d.mean, 3);
  EXPECT_DOUBLE_EQ(d.standard_error, std::sqrt(7.0 / 3));
}

TEST(PairedDifference, LeavesOutWhatIsUndefined) {
  const PairedDifference d = paired_difference(std::vector{1.0, std::nan("")}, std::vector{3.0, 2.0});
  EXPECT_EQ(d.num_pairs, 1);
  EXPECT_EQ(d.mean, 2);
  EXPECT_TRUE(std::isnan(d.standard_error));
  EXPECT_TRUE(std::isnan(paired_difference({}, {}).mean));
  EXPECT_THROW((void)paired_difference(std::vector{1.0}, {}), std::invalid_argument);
}

EvaluatedRun run_with(const std::string& sequence, const std::string& preset, const RecognitionScore& score) {
  EvaluatedRun run;
  run.sequence = sequence;
  run.preset = preset;
  run.num_previous_views = 5;
  run.num_former_places = 2;
  run.views.resize(1);
  run.views[0].score = score;
  run.views[0].times.add("features", 1, preset == "mvr" ? 2 : 3);
  run.views[0].times.add("search", 1, preset == "mvr" ? 2 : 5);
  run.has_changes = sequence == "1";
  run.events.events = {1, preset == "mvr" ? 2 : 0, 0};
  run.views[0].detections.resize(1);
  run.views[0].detections[0].verdict = preset == "mvr" ? DetectionVerdict::kGhost : DetectionVerdict::kFalsePositive;
  return run;
}

TEST(ComparePresets, PairsBySequence) {
  // The second sequence is harder for both; the third was run with one preset only.
  const auto comparisons = compare_presets(
      std::vector{run_with("1", "mvr", {5, 5, 0}), run_with("2", "mvr", {1, 9, 0}), run_with("3", "mvr", {1, 0, 0}),
                  run_with("2", "mvr-chd", {2, 8, 0}), run_with("1", "mvr-chd", {6, 4, 0})});
  ASSERT_EQ(comparisons.size(), 1U);
  EXPECT_EQ(comparisons[0].b, "mvr-chd");
  EXPECT_EQ(comparisons[0].precision.num_pairs, 2);
  EXPECT_NEAR(comparisons[0].precision.mean, 0.1, 1e-12);
  EXPECT_NEAR(comparisons[0].precision.standard_error, 0, 1e-12);
  EXPECT_DOUBLE_EQ(comparisons[0].ghosts_per_change.mean, -0.5);
  EXPECT_EQ(comparisons[0].score_of_a, (RecognitionScore{6, 14, 0}));
  EXPECT_EQ(comparisons[0].score_of_b, (RecognitionScore{8, 12, 0}));
  // Stages are added up: 8 s instead of 4 s.
  EXPECT_NEAR(comparisons[0].log_cpu.mean, std::log(2.0), 1e-12);
  EXPECT_EQ(comparisons[0].event_f_score.num_pairs, 1);
  EXPECT_DOUBLE_EQ(comparisons[0].event_f_score.mean, 0.5);
}

TEST(ComparePresets, ASequenceWithoutDetectionsCounts) {
  const auto comparisons =
      compare_presets(std::vector{run_with("1", "mvr", {0, 0, 5}), run_with("1", "mvr-chd", {4, 0, 1})});
  ASSERT_EQ(comparisons.size(), 1U);
  EXPECT_EQ(comparisons[0].num_sequences, 1);
  EXPECT_EQ(comparisons[0].precision.num_pairs, 0);
  EXPECT_DOUBLE_EQ(comparisons[0].recall.mean, 0.8);
}

TEST(ComparePresets, WithoutTimesTheirRatioIsUnknown) {
  EvaluatedRun a = run_with("1", "mvr", {1, 0, 0}), b = run_with("1", "mvr-chd", {1, 0, 0});
  a.views[0].times = {};
  const auto comparisons = compare_presets(std::vector{a, b});
  ASSERT_EQ(comparisons.size(), 1U);
  EXPECT_TRUE(std::isnan(comparisons[0].log_cpu.mean));
}

}  // namespace
}  // namespace resight
