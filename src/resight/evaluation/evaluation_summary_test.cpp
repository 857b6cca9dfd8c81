// SPDX-License-Identifier: Apache-2.0
#include "resight/evaluation/evaluation_summary.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace resight {
namespace {

EvaluatedRun make_run(const std::string& sequence, const std::string& preset, int k) {
  EvaluatedRun run;
  run.sequence = sequence;
  run.preset = preset;
  run.num_previous_views = k;
  run.fingerprint = "0123";
  run.num_former_places = 2;
  run.num_published_places = 3;
  run.has_changes = true;
  run.events.events = {1, 2, 3};
  run.events.delays = {0, 4};
  EvaluatedView view;
  view.name = "00000";
  EvaluatedTruth found;
  found.object = "mug";
  found.visible_share = 0.9;
  found.found = found.found_strictly = true;
  found.center_error_m = 0.1 / 3;  // Not a short decimal.
  found.rotation_error_rad = 1e-17;
  EvaluatedTruth missed;
  missed.object = "soup";
  missed.lost_at = "rejected";
  view.truth = {found, missed};
  view.detections = {{"mug", Rigid3::from_axis_angle({0, 0.6, 0.8}, 0.7), 0.5, DetectionVerdict::kCorrect},
                     {"soup", Rigid3::from_translation({0.1, 0.2, 0.3}), 0.25, DetectionVerdict::kGhost}};
  view.score = {1, 1, 1};
  view.strict_score = {1, 1, 1};
  view.num_detected_former_places = 2;
  view.counts = {100, 10, 20, 5, 2};
  view.points.removed = {10, 5, 8, 4};
  view.times.add("sift", 0.25, 0.5);
  run.views = {view, view};
  return run;
}

TEST(EvaluatedRun, ComesBackToTheBit) {
  const EvaluatedRun run = make_run("a", "mvr", 3);
  const auto back = parse_run(format_run(run), "a.json");
  ASSERT_TRUE(back.ok()) << back.error().message;
  EXPECT_EQ(format_run(*back), format_run(run));
  EXPECT_EQ(back->views[1].truth[0].center_error_m, 0.1 / 3);
  EXPECT_TRUE(std::isnan(back->views[1].truth[1].visible_share));
  EXPECT_EQ(back->views[0].detections[0].camera_from_object.rotation,
            run.views[0].detections[0].camera_from_object.rotation);
  EXPECT_EQ(back->num_ghosts(), 2);
  EXPECT_EQ(back->num_published_places, 3);
  EXPECT_EQ(back->views[0].num_detected_former_places, 2);
  EXPECT_EQ(back->events.delays, run.events.delays);
}

TEST(EvaluatedRun, DamageIsReportedInOneLine) {
  std::string text = format_run(make_run("a", "mvr", 3));
  std::string high_score = text;
  high_score.replace(high_score.find("\"score\":0.5"), 11, "\"score\":1.5");
  const auto with = [&](const std::string& what, const std::string& by) {
    std::string changed = text;
    return changed.replace(changed.find(what), what.size(), by);
  };
  // Names that are printed into tables as they are.
  const std::string stage = with("\"rejected\"", "\"a | b\"");
  const std::string time = with("\"sift\"", "\"a | b\"");
  const std::string preset = with("\"mvr\"", "\"a | b\"");
  // Numbers that no run has, and that would not fit into the integers of the sums.
  const std::string huge = with("\"num_threads\":1", "\"num_threads\":1e300");
  const std::string many = with("\"score\":[1", "\"score\":[2000000000");
  const std::string unsigned_count = with("\"score\":[1", "\"score\":[18446744073709551615");
  const std::string negative = with("\"novel_points\":[0", "\"novel_points\":[-5");
  const std::string early = with("\"delays_views\":[0", "\"delays_views\":[-1");
  const std::string near = with("\"distance_m\":0.0", "\"distance_m\":-2.0");
  const std::string quick = with("0.25,0.5]", "-0.25,0.5]");
  const std::string skew = with("[1.0,0.0,0.0,0.1", "[3.0,0.0,0.0,0.1");
  for (const std::string& bad :
       {huge, many, unsigned_count, negative, early, near, quick, skew, text.substr(0, text.size() / 2), high_score,
        stage, time, preset, std::string("[]"), std::string()}) {
    const auto run = parse_run(bad, "a.json");
    ASSERT_FALSE(run.ok()) << bad;
    EXPECT_TRUE(run.error().message.starts_with("a.json: ")) << run.error().message;
    EXPECT_EQ(run.error().message.find('\n'), std::string::npos);
  }
}

TEST(SummarizeRuns, SumsBeforeItDivides) {
  EvaluatedRun empty = make_run("b", "mvr", 3);
  empty.views.resize(1);
  empty.views[0].score = {0, 0, 7};
  const std::vector<ConfigurationSummary> all =
      summarize_runs(std::vector{make_run("a", "mvr", 3), empty, make_run("a", "mvr", 0)});
  ASSERT_EQ(all.size(), 2U);
  EXPECT_EQ(all[0].num_previous_views, 0);
  const ConfigurationSummary& c = all[1];
  EXPECT_EQ(c.num_sequences, 2);
  EXPECT_EQ(c.num_views, 3);
  EXPECT_EQ(c.score, (RecognitionScore{2, 2, 9}));
  EXPECT_NEAR(c.reliability.calibration_error(), (0.5 + 0.25) / 2, 1e-12) << "right at 0.5, and a ghost at 0.25";
  EXPECT_DOUBLE_EQ(c.score.recall(), 2.0 / 11);
  EXPECT_EQ(c.ghosts.num_detections, 3);
  EXPECT_DOUBLE_EQ(c.ghosts.per_former_place(), 0.75);
  EXPECT_EQ(c.ghosts.num_by_published_rule, 6);
  EXPECT_EQ(c.ghosts.num_published_places, 6);
  EXPECT_EQ(c.counts.merged, 60);
  EXPECT_EQ(c.changes.events.events, (RecognitionScore{2, 4, 6}));
  EXPECT_DOUBLE_EQ(c.changes.points.removed.recall(), 0.5);
  EXPECT_EQ(c.found.by_object.at("mug").found, 3);
  EXPECT_EQ(c.found.by_object.at("soup").missed, 3);
  EXPECT_EQ(c.found.by_object.at("soup").false_positives, 3);
  EXPECT_EQ(c.found.lost_at.at("rejected"), 3);
  EXPECT_EQ(c.found.by_visible_share[4].found, 3);       // 0.8 to 1
  EXPECT_EQ(c.found.by_visible_share.back().missed, 3);  // Unknown.
  ASSERT_EQ(c.times.mean_view_wall_s.size(), 2U);
  EXPECT_DOUBLE_EQ(c.times.mean_view_wall_s[1], 0.25);
}

TEST(SummarizeRuns, TheOrderOfSequencesDoesNotMatter) {
  EvaluatedRun other = make_run("b", "mvr", 3);
  other.events.delays = {9};
  const auto forth = summarize_runs(std::vector{make_run("a", "mvr", 3), other});
  const auto back = summarize_runs(std::vector{other, make_run("a", "mvr", 3)});
  EXPECT_EQ(forth[0].changes.events.delays, back[0].changes.events.delays);
}

TEST(ErrorQuantiles, NearestRank) {
  std::vector<double> values;
  for (int i = 20; i >= 1; --i) values.push_back(i);
  const ErrorQuantiles q = error_quantiles(values);
  EXPECT_EQ(q.count, 20);
  EXPECT_EQ(q.median, 10);
  EXPECT_EQ(q.p95, 19);
  EXPECT_TRUE(std::isnan(error_quantiles({}).median));
  EXPECT_EQ(error_quantiles({7}).p95, 7);
}

}  // namespace
}  // namespace resight
