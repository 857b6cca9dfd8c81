// SPDX-License-Identifier: Apache-2.0
#include "resight/report/evaluation_report.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <sstream>

#include "resight/report/line_plot.hpp"

namespace resight {
namespace {

namespace fs = std::filesystem;

EvaluatedRun make_evaluated_run(const std::string& preset, int k, bool clustered = true) {
  EvaluatedRun run;
  run.sequence = "000001";
  run.preset = preset;
  run.num_previous_views = k;
  run.is_clustered = clustered;
  run.num_former_places = 4;
  run.has_changes = preset != "mvr";
  EvaluatedView view;
  view.name = "000000";
  EvaluatedTruth missed;
  missed.object = "mug";
  missed.visible_share = 0.5;
  missed.lost_at = "no keypoints";
  view.truth = {missed};
  view.detections = {{"mug", Rigid3::from_translation({0, 0, 1.5}), 0.5, DetectionVerdict::kGhost}};
  view.score = {3, 1, 1};
  view.strict_score = {2, 2, 2};
  view.counts = {100, 10, 20, clustered ? 5 : 20, 2};
  view.times.add("sift", 0.125, 0.25);
  EvaluatedView worse = view;
  worse.name = "000001";
  worse.score = {0, 1, 9};
  run.views = {view, worse};
  return run;
}

std::vector<EvaluatedRun> make_runs() {
  return {make_evaluated_run("mvr", 0), make_evaluated_run("mvr", 5), make_evaluated_run("mvr", 5, false),
          make_evaluated_run("mvr-chd", 0), make_evaluated_run("mvr-chd", 5)};
}

// Rows of a Markdown table must have as many cells as the header.
void expect_whole_tables(const std::string& text) {
  std::istringstream lines(text);
  std::ptrdiff_t bars = 0;
  int rows = 0;
  for (std::string line; std::getline(lines, line);) {
    if (!line.starts_with("|")) {
      bars = 0;
      continue;
    }
    ++rows;
    const auto count = std::ranges::count(line, '|');
    if (bars == 0) bars = count;
    EXPECT_EQ(count, bars) << line;
  }
  EXPECT_GT(rows, 8);
}

TEST(EvaluationReport, TablesAreWholeAndHoldTheNumbers) {
  const std::vector<EvaluatedRun> runs = make_runs();
  const std::vector<ConfigurationSummary> summaries = summarize_runs(runs);
  const std::string text = format_evaluation_tables({"set", "1.2.3"}, summaries, compare_presets(runs));
  expect_whole_tables(text);
  expect_whole_tables(format_evaluation_times({"set", "1.2.3"}, summaries));
  EXPECT_NE(text.find("| `mvr` | 5 | 0.600 | 0.231 | 0.333 |"), std::string::npos) << text;
  EXPECT_NE(text.find("| 2 | 0.50 |"), std::string::npos);          // Ghosts, and per former place.
  EXPECT_NE(text.find("| 40 | 10 | 25.0 % |"), std::string::npos);  // Clustering keeps 10 of 40.
  EXPECT_NE(text.find("no keypoints"), std::string::npos);
  EXPECT_NE(text.find("| `mvr` | 5 | 0.500 | - | - | 0.500 / 0.000 (2) | - |"), std::string::npos)
      << "two ghosts of score 0.5";
  EXPECT_NE(text.find("| `mvr-chd` - `mvr` | 5 | 1 | +0.000 ± - |"), std::string::npos);
}

TEST(EvaluationReport, TimesHoldTheSharesOfChangesAndClustering) {
  std::vector<EvaluatedRun> runs{make_evaluated_run("mvr-chd", 5), make_evaluated_run("mvr-chd", 5, false)};
  for (EvaluatedRun& run : runs)
    for (EvaluatedView& view : run.views) {
      view.times.add("changes and reconstruction", 0.05, 0.1);
      view.times.add("presence", 0.01, 0.05);
      view.times.add("cluster", 0.01, 0.02);
      view.times.add("verification", 0.25, run.is_clustered ? 0.58 : 0.725);
    }
  runs[1].num_threads = 8;
  const std::string text = format_evaluation_times({"set", "1"}, summarize_runs(runs));
  expect_whole_tables(text);
  EXPECT_NE(text.find("Threads: 1, 8."), std::string::npos) << text;
  // Of 250 + 100 + 50 + 20 + 580 ms, changes take 150; clustering saves 145 of 725 ms.
  EXPECT_NE(text.find("| `mvr-chd` | 5 | 445.0 | 1000.0 | 100.0 | 50.0 | 15.0 % | 20.0 | 580.0 |"), std::string::npos)
      << text;
  EXPECT_NE(text.find("| `mvr-chd` | 5 | 20.0 | 725.0 | 580.0 | 145.0 | 20.0 % |"), std::string::npos) << text;
}

TEST(EvaluationReport, VerificationTimesAreThoseOfEachView) {
  std::vector<EvaluatedRun> runs{make_evaluated_run("mvr", 5), make_evaluated_run("mvr", 5, false)};
  runs[0].views[1].times.add("verification", 0.25, 0.5);
  const std::string text = format_verification_times(runs);
  EXPECT_EQ(std::ranges::count(text, '\n'), 5) << "a head, and two views of each run";
  EXPECT_NE(text.find("\n000001,mvr,5,1,0,5,0.000000,0.000000\n000001,mvr,5,1,1,5,0.250000,0.500000\n"),
            std::string::npos)
      << text;
  EXPECT_NE(text.find("\n000001,mvr,5,0,1,20,"), std::string::npos) << text;
}

TEST(EvaluationReport, NamesOfFoldersDoNotBreakRows) {
  std::vector<EvaluatedRun> runs{make_evaluated_run("mvr", 5)};
  runs[0].sequence = "a,\"b\"\n\x1b[31m";
  const std::string text = format_verification_times(runs);
  EXPECT_EQ(std::ranges::count(text, '\n'), 3);
  EXPECT_NE(text.find("\n\"a,\"\"b\"\"\\x0a\\x1b[31m\",mvr,5,"), std::string::npos) << text;
}

TEST(EvaluationReport, NamesDoNotBreakTables) {
  std::vector<EvaluatedRun> runs = make_runs();
  int renamed = 0;
  for (EvaluatedRun& run : runs)
    for (EvaluatedView& view : run.views)
      for (EvaluatedTruth& truth : view.truth) {
        truth.object = "cup | <b>";
        ++renamed;
      }
  ASSERT_GT(renamed, 0);
  const std::string text = format_evaluation_tables({"set\n# x", "1"}, summarize_runs(runs), {});
  expect_whole_tables(text);
  EXPECT_NE(text.find("| cup &#124; \\<b\\> |"), std::string::npos) << text;
  EXPECT_EQ(text.find("\n# x"), std::string::npos);
}

TEST(EvaluationReport, JsonHoldsScoresAndNoTimes) {
  const std::vector<EvaluatedRun> runs = make_runs();
  const std::string text = format_evaluation_json({"set", "1.2.3"}, summarize_runs(runs));
  const nlohmann::json json = nlohmann::json::parse(text);
  ASSERT_EQ(json["configurations"].size(), 5U);
  EXPECT_EQ(json["configurations"][1]["num_previous_views"], 5);
  EXPECT_DOUBLE_EQ(json["configurations"][1]["score_5cm_30deg"]["recall"].get<double>(), 3.0 / 13);
  EXPECT_EQ(json["configurations"][1]["reliability"]["calibration_error"], 0.5);
  EXPECT_EQ(json["configurations"][1]["reliability"]["by_score"][2]["detections"], 2);
  EXPECT_TRUE(json["configurations"][1]["reliability"]["by_score"][0]["share_right"].is_null());
  EXPECT_TRUE(json["configurations"][0]["changes"].is_null());
  EXPECT_FALSE(json["configurations"][3]["changes"].is_null());
  EXPECT_EQ(text.find("wall"), std::string::npos);
}

TEST(EvaluationReport, WritesAllFiles) {
  const fs::path directory = fs::temp_directory_path() / ("resight_evaluation_" + std::to_string(::getpid()));
  fs::remove_all(directory);
  const auto written = write_evaluation(directory, {"set", "1"}, make_runs());
  ASSERT_TRUE(written.ok()) << written.error().message;
  int count = 0;
  for (const char* name :
       {"results.json", "times.json", "tables.md", "times.md", "worst.md", "precision.svg", "recall.svg", "f.svg",
        "ghosts.svg", "view_time.svg", "verification_time.svg", "verification_times.csv"}) {
    EXPECT_GT(fs::file_size(directory / name), 100U) << name;
    ++count;
  }
  EXPECT_EQ(std::distance(fs::directory_iterator(directory), fs::directory_iterator()), count);
  fs::remove_all(directory);
}

TEST(LinePlot, DrawsEachPointInsideThePicture) {
  LinePlot plot{"P & R", "K", "share", {{"mvr", {0, 1, 2}, {0.9, std::nan(""), 0.7}}, {"<chd>", {0, 2}, {0.9, 0.8}}},
                0.0,     1.0};
  const std::string svg = format_svg(plot);
  std::size_t circles = 0;
  for (std::size_t at = svg.find("<circle"); at != std::string::npos; at = svg.find("<circle", at + 1)) ++circles;
  EXPECT_EQ(circles, 4U);
  EXPECT_NE(svg.find("P &amp; R"), std::string::npos);
  EXPECT_NE(svg.find("&lt;chd&gt;"), std::string::npos);
  EXPECT_EQ(svg.find("nan"), std::string::npos);
  plot.series[0].y.pop_back();
  EXPECT_THROW((void)format_svg(plot), std::invalid_argument);
}

TEST(LinePlot, CopesWithNothingAndWithOneValue) {
  EXPECT_EQ(format_svg({"", "", "", {}, {}, {}}).find("nan"), std::string::npos);
  EXPECT_EQ(format_svg({"", "", "", {{"a", {3}, {0}}}, {}, {}}).find("inf"), std::string::npos);
}

}  // namespace
}  // namespace resight
