// SPDX-License-Identifier: Apache-2.0
#include "resight/report/results.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>
#include <functional>
#include <iterator>
#include <nlohmann/json.hpp>
#include <regex>
#include <set>
#include <sstream>
#include <stdexcept>

#include "resight/report/report_test_scene.hpp"

namespace resight {
namespace {

using namespace resight::test;
namespace fs = std::filesystem;
using nlohmann::json;

std::vector<std::string> split(const std::string& text, char separator) {
  std::vector<std::string> parts;
  std::istringstream in(text);
  for (std::string part; std::getline(in, part, separator);) parts.push_back(part);
  return parts;
}

std::string read_all(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

/// A temporary folder per test.
class ResultsFolder : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() / ("resight_results_test_" + std::to_string(::getpid()));
    fs::remove_all(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }
  fs::path folder_;
};

TEST(FormatDetectionsCsv, FollowsTheBopFormat) {
  ReportRun run = make_run();
  run.views[0].scene_id = 7;
  run.views[0].image_id = 42;
  const ModelLibrary library = make_library();
  const std::vector<std::string> lines = split(format_detections_csv(run, library), '\n');
  ASSERT_EQ(lines.size(), 4U);
  EXPECT_EQ(lines[0], "scene_id,im_id,obj_id,score,R,t,time");
  const std::vector<std::string> cells = split(lines[2], ',');
  ASSERT_EQ(cells.size(), 7U);
  EXPECT_EQ(cells[0], "7");
  EXPECT_EQ(cells[1], "42");
  EXPECT_EQ(cells[2], "12") << "the slab's obj_id";
  EXPECT_EQ(cells[3], "0.875");
  EXPECT_EQ(split(lines[1], ',')[6], cells[6]) << "one time for all rows of an image";
  EXPECT_EQ(std::stod(cells[6]), 0.25);
}

TEST(FormatDetectionsCsv, PosesReadBackExactly) {
  const RgbdFrame frame = make_frame();
  const ModelLibrary library = make_library();
  SceneUpdate update = make_update(frame, 0);
  const Rigid3 camera_from_object = at(0.1, -0.2, 0.9) * Rigid3::from_axis_angle(Eigen::Vector3d(3, -1, 2), 1.234);
  update.detections = {make_detection(frame, 0, camera_from_object)};
  ReportRun run;
  run.views.push_back(make_view_record(frame, library, update, std::nullopt, {.picture = false}));
  const std::vector<std::string> cells = split(split(format_detections_csv(run, library), '\n').at(1), ',');
  const std::vector<std::string> r = split(cells.at(4), ' ');
  const std::vector<std::string> t = split(cells.at(5), ' ');
  ASSERT_EQ(r.size(), 9U);
  ASSERT_EQ(t.size(), 3U);
  const Rigid3 written = update.world_from_camera.inverse() * update.detections[0].world_from_object;
  for (int i = 0; i < 9; ++i) EXPECT_EQ(std::stod(r[static_cast<std::size_t>(i)]), written.rotation(i / 3, i % 3));
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(std::stod(t[static_cast<std::size_t>(i)]), written.translation[i] * 1000.0);
    EXPECT_NEAR(std::stod(t[static_cast<std::size_t>(i)]), camera_from_object.translation[i] * 1000.0, 1e-9);
  }
}

TEST(FormatDetectionsJson, HoldsAllThatIsKnown) {
  const json parsed = json::parse(format_detections_json(make_run(), make_library()));
  EXPECT_EQ(parsed["version"], "1.2.3");
  EXPECT_EQ(parsed["preset"], "default");
  ASSERT_EQ(parsed["views"].size(), 2U);
  const json& view = parsed["views"][0];
  EXPECT_EQ(view["name"], "view0");
  ASSERT_EQ(view["detections"].size(), 2U);
  const json& slab = view["detections"][1];
  EXPECT_EQ(slab["object"], "slab");
  EXPECT_EQ(slab["obj_id"], 12);
  EXPECT_EQ(slab["track"], 2);
  EXPECT_NEAR(slab["camera_from_object"]["translation_m"][2].get<double>(), 1.1, 1e-12);
  EXPECT_EQ(slab["camera_from_object"]["rotation"].size(), 9U);
  EXPECT_EQ(slab["evidence"][0]["explained_share"], 0.75);
  EXPECT_EQ(slab["evidence"][1]["allowed"], false);
  EXPECT_TRUE(slab["evidence"][1]["explained_share"].is_null()) << "NaN";
  EXPECT_FALSE(slab.contains("verdict")) << "no ground truth";
  EXPECT_FALSE(view.contains("left_out"));
}

TEST(FormatDetectionsJson, NamesWhatThereWasNoTimeFor) {
  ReportRun run = make_run();
  run.views[1].update.left_out = {"shape search"};
  const json parsed = json::parse(format_detections_json(run, make_library()));
  EXPECT_EQ(parsed["views"][1]["left_out"], json({"shape search"}));
}

TEST(FormatDetectionsJson, HoldsWhatTheDocumentSays) {
  const fs::path document = fs::path(__FILE__).parent_path() / "../../../docs/formats.md";
  if (!fs::exists(document)) GTEST_SKIP() << "no " << document;
  const std::string all = read_all(document);
  const std::size_t begin = all.find("\n## Detections");
  const std::string text = all.substr(begin, all.find("\n## ", begin + 1) - begin);
  ReportRun run = make_run();
  run.views[0].update.left_out = {"shape search"};
  run.views[0].evaluation.emplace();
  run.views[0].marks.resize(run.views[0].update.detections.size());
  const json view = json::parse(format_detections_json(run, make_library()))["views"][0];
  std::set<std::string> keys;
  const std::function<void(const json&)> collect = [&](const json& value) {
    if (value.is_object())
      for (const auto& [key, item] : value.items()) keys.insert(key);
    for (const json& item : value)
      if (item.is_structured()) collect(item);
  };
  collect(view);
  for (const std::string& key : keys) EXPECT_NE(text.find("`" + key + "`"), std::string::npos) << key;
  const json& detection = view["detections"][0];
  std::istringstream lines(text);
  int num_rows = 0;
  const std::regex name("`([a-z_]+)`");
  for (std::string line; std::getline(lines, line);) {
    if (!line.starts_with("| `")) continue;
    ++num_rows;
    const std::string first = line.substr(1, line.find('|', 1));
    for (auto it = std::sregex_iterator(first.begin(), first.end(), name); it != std::sregex_iterator(); ++it)
      EXPECT_TRUE(detection.contains((*it)[1].str())) << (*it)[1];
  }
  EXPECT_GE(num_rows, 9);
}

TEST(FormatViewLine, IsTheViewOfTheDetectionsWithItsEvents) {
  const ReportRun run = make_run();
  const json views = json::parse(format_detections_json(run, make_library()))["views"];
  for (std::size_t v = 0; v < run.views.size(); ++v) {
    const std::string line = format_view_line(run.views[v], make_library());
    EXPECT_EQ(line.find('\n'), std::string::npos);
    json parsed = json::parse(line);
    EXPECT_EQ(parsed["events"].size(), run.views[v].update.events.size());
    parsed.erase("events");
    EXPECT_EQ(parsed, views[v]);
  }
}

TEST(FormatChangesJson, HoldsEventsOfAllViews) {
  const json parsed = json::parse(format_changes_json(make_run(), make_library()));
  ASSERT_EQ(parsed["events"].size(), 4U);
  const json& moved = parsed["events"][2];
  EXPECT_EQ(moved["kind"], "moved");
  EXPECT_EQ(moved["object"], "ball");
  EXPECT_EQ(moved["view"], 1);
  EXPECT_FALSE(moved["world_from_object_before"].is_null());
  EXPECT_FALSE(moved["world_from_object_after"].is_null());
  EXPECT_TRUE(parsed["events"][3]["world_from_object_after"].is_null());
  EXPECT_EQ(parsed["views"][1]["novel_points"], 4000);
  EXPECT_EQ(parsed["views"][1]["changed_share"], 0.125);
}

TEST(FormatSummaryJson, HoldsSettingsTimesAndScores) {
  ReportRun run = make_run();
  json parsed = json::parse(format_summary_json(run));
  EXPECT_EQ(parsed["settings"]["changes.tolerance_m"], "0.02");
  EXPECT_EQ(parsed["stages"][0]["stage"], "features");
  EXPECT_EQ(parsed["stages"][0]["wall_s_per_view"], 0.25);
  EXPECT_EQ(parsed["peak_memory_bytes"], 123000000);
  EXPECT_EQ(parsed["num_changes"], 2);
  EXPECT_FALSE(parsed.contains("evaluation"));

  run.views[0].evaluation.emplace();
  run.views[0].evaluation->matching.score = {0, 0, 2};
  parsed = json::parse(format_summary_json(run));
  EXPECT_EQ(parsed["evaluation"]["score"]["false_negatives"], 2);
  EXPECT_EQ(parsed["evaluation"]["score"]["recall"], 0.0);
  EXPECT_TRUE(parsed["evaluation"]["score"]["precision"].is_null());

  EXPECT_TRUE(parsed.at("color_offset").is_null());
  EXPECT_TRUE(parsed.at("pose_correction").is_null());
  EXPECT_FALSE(parsed.contains("num_skipped_views"));
  run.num_skipped_views = 3;
  run.views.back().update.camera_errors.color_offset = {{2.25, -1.5}, {0.25, 0.5}, 7};
  parsed = json::parse(format_summary_json(run));
  EXPECT_EQ(parsed.at("color_offset"), json::parse(R"({"offset_px": [2.25, -1.5], "sigma_px": [0.25, 0.5],
                                                      "num_views": 7, "corrected_px": [2.25, -1.5]})"));
  EXPECT_EQ(parsed.at("num_skipped_views"), 3);
  run.views.front().update.pose_correction = {.is_measured = true, .moved_m = 0, .sigma_m = 0.001};
  run.views.back().update.pose_correction = {true, 0.03, 0.02, 0.002, 0.001};
  parsed = json::parse(format_summary_json(run));
  EXPECT_EQ(parsed.at("pose_correction"), json::parse(R"({"num_views": 2, "num_corrected": 1, "largest_m": 0.03,
      "largest_rad": 0.02, "median_m": 0.03, "median_rad": 0.02, "sigma_m": 0.002, "sigma_rad": 0.001})"));
}

// The lists are never in memory as a whole. The layout is the one of the JSON library all the same.
TEST(FormatResults, ListsInPartsHaveTheLayoutOfTheWhole) {
  ReportRun named = make_run();
  named.views[0].update.view_name = "line\n  \"break\"\xff";
  ReportRun empty = make_run();
  empty.views.clear();
  for (const ReportRun& run : {named, empty})
    for (const std::string& text :
         {format_detections_json(run, make_library()), format_changes_json(run, make_library())})
      EXPECT_EQ(text, nlohmann::ordered_json::parse(text).dump(1) + "\n");
}

TEST(FormatResults, RefusesObjectsThatAreNotInTheLibrary) {
  ReportRun run = make_run();
  run.views[0].update.detections[0].object = 99;
  run.views[1].update.events[0].object = -1;
  EXPECT_THROW((void)format_detections_csv(run, make_library()), std::invalid_argument);
  EXPECT_THROW((void)format_detections_json(run, make_library()), std::invalid_argument);
  EXPECT_THROW((void)format_changes_json(run, make_library()), std::invalid_argument);
}

TEST_F(ResultsFolder, HoldsTheFourFilesAndNothingElse) {
  const ReportRun run = make_run();
  ASSERT_TRUE(write_results(folder_ / "deep" / "er", run, make_library()).ok());
  ASSERT_TRUE(write_results(folder_ / "deep" / "er", run, make_library()).ok()) << "older files are replaced";
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder_ / "deep" / "er")) names.push_back(entry.path().filename());
  std::sort(names.begin(), names.end());
  EXPECT_EQ(names, (std::vector<std::string>{"changes.json", "detections.csv", "detections.json", "summary.json"}));
  EXPECT_EQ(read_all(folder_ / "deep" / "er" / "summary.json"), format_summary_json(run));
}

TEST_F(ResultsFolder, AFileInTheWayIsAnErrorThatNamesIt) {
  fs::create_directories(folder_);
  std::ofstream(folder_ / "taken") << "a file";
  const Result<void> written = write_results(folder_ / "taken", make_run(), make_library());
  ASSERT_FALSE(written.ok());
  EXPECT_NE(written.error().message.find("taken"), std::string::npos) << written.error().message;
  EXPECT_EQ(read_all(folder_ / "taken"), "a file");
}

TEST_F(ResultsFolder, NothingHalfWrittenStaysBehind) {
  // The target is a folder, so the final renaming fails.
  fs::create_directories(folder_ / "detections.csv" / "full");
  ASSERT_FALSE(write_results(folder_, make_run(), make_library()).ok());
  int entries = 0;
  for ([[maybe_unused]] const auto& entry : fs::directory_iterator(folder_)) ++entries;
  EXPECT_EQ(entries, 1);
}

}  // namespace
}  // namespace resight
