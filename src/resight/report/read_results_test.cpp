// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <functional>
#include <iterator>
#include <nlohmann/json.hpp>

#include "resight/core/random.hpp"
#include "resight/io/recognition_results.hpp"
#include "resight/report/report_test_scene.hpp"
#include "resight/report/results.hpp"
#include "resight/report/stored_view.hpp"

namespace resight {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using testing::HasSubstr;

/// Results of a run in a folder, which tests then damage.
class ReadResults : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() / ("resight_read_results_test_" + std::to_string(::getpid()));
    fs::remove_all(folder_);
    ReportRun run = test::make_run();
    run.sequence_path = "../data/000001";
    run.models_path = "/models/all.resight";
    run.sequence_options = {"--every", "2", "--poses", "detections.json"};  // A file that is there.
    ASSERT_TRUE(write_results(folder_, run, test::make_library()).ok());
  }
  void TearDown() override { fs::remove_all(folder_); }
  [[nodiscard]] json load(const char* file) const {
    std::ifstream in(folder_ / file);
    return json::parse(in);
  }
  void store(const char* file, const std::string& text) const { std::ofstream(folder_ / file) << text; }
  /// The error after a change of one file.
  [[nodiscard]] std::string error_after(const char* file, const std::function<void(json&)>& change) const {
    const json whole = load(file);
    json damaged = whole;
    change(damaged);
    store(file, damaged.dump());
    const auto results = read_recognition_results(folder_);
    store(file, whole.dump());
    return results.ok() ? "none" : results.error().message;
  }
  fs::path folder_;
};

TEST_F(ReadResults, ReadsWhatWasWritten) {
  EXPECT_TRUE(has_recognition_results(folder_));
  store("2", "no value of --every");
  const auto results = read_recognition_results(folder_);
  ASSERT_TRUE(results.ok()) << results.error().message;
  const ReportRun run = test::make_run();
  EXPECT_EQ(results->preset, "default");
  EXPECT_EQ(results->sequence_options,
            (std::vector<std::string>{"--every", "2", "--poses", (folder_ / "detections.json").string()}));
  EXPECT_EQ(results->version, "1.2.3");
  EXPECT_EQ(results->sequence, (folder_ / "../data/000001").lexically_normal());
  EXPECT_EQ(results->models, "/models/all.resight");
  ASSERT_EQ(results->views.size(), run.views.size());
  int num_checked = 0;
  for (std::size_t v = 0; v < run.views.size(); ++v) {
    const SceneUpdate& update = run.views[v].update;
    const StoredView& view = results->views[v];
    EXPECT_EQ(view.name, update.view_name);
    EXPECT_TRUE(is_same_pose(view.world_from_camera, update.world_from_camera));
    EXPECT_EQ(view.changed_share, update.changes.changed_share);
    ASSERT_EQ(view.detections.size(), update.detections.size());
    for (std::size_t d = 0; d < view.detections.size(); ++d, ++num_checked) {
      EXPECT_TRUE(is_same_pose(view.detections[d].world_from_object, update.detections[d].world_from_object));
      EXPECT_EQ(view.detections[d].track, update.detections[d].track);
      EXPECT_EQ(view.detections[d].score, update.detections[d].score);
      ASSERT_EQ(view.detections[d].evidence.size(), 2U);
      EXPECT_TRUE(std::isnan(view.detections[d].evidence[1].explained_share));
      EXPECT_FALSE(view.detections[d].covariance.has_value());
    }
  }
  EXPECT_EQ(num_checked, 3);
  ASSERT_EQ(results->events.size(), 4U);
  EXPECT_EQ(results->events[2].kind, "moved");
  EXPECT_TRUE(results->events[2].world_from_object_before.has_value());
  EXPECT_FALSE(results->events[3].world_from_object_after.has_value());
}

TEST_F(ReadResults, EqualsWhatTheViewerGetsDuringTheRun) {
  const auto results = read_recognition_results(folder_);
  ASSERT_TRUE(results.ok());
  const ReportRun run = test::make_run();
  const ModelLibrary library = test::make_library();
  std::vector<StoredEvent> events;
  for (std::size_t v = 0; v < run.views.size(); ++v) {
    const StoredView live = to_stored_view(run.views[v], library);
    const StoredView& read = results->views.at(v);
    EXPECT_EQ(live.name, read.name);
    EXPECT_EQ(live.num_novel_points, read.num_novel_points);
    ASSERT_EQ(live.detections.size(), read.detections.size());
    for (std::size_t d = 0; d < live.detections.size(); ++d) {
      EXPECT_EQ(live.detections[d].object, read.detections[d].object);
      EXPECT_EQ(live.detections[d].bop_id, read.detections[d].bop_id);
      EXPECT_EQ(live.detections[d].verdict, read.detections[d].verdict);
      EXPECT_EQ(live.detections[d].evidence.size(), read.detections[d].evidence.size());
    }
    std::ranges::move(to_stored_events(run.views[v], library), std::back_inserter(events));
  }
  ASSERT_EQ(events.size(), results->events.size());
  for (std::size_t i = 0; i < events.size(); ++i) {
    EXPECT_EQ(events[i].kind, results->events[i].kind);
    EXPECT_EQ(events[i].object, results->events[i].object);
    EXPECT_EQ(events[i].world_from_object_after.has_value(), results->events[i].world_from_object_after.has_value());
  }
}

TEST_F(ReadResults, NamesTheFirstFault) {
  const auto detection = [](json& file) -> json& { return file["views"][0]["detections"][0]; };
  const std::pair<std::function<void(json&)>, const char*> faults[] = {
      {[](json& f) { f = 3; }, "version: expected a text"},
      {[](json& f) { f["views"] = "none"; }, "views: expected a list"},
      {[](json& f) { f["views"][1]["view"] = 7; }, "views[1].view: views are not in order"},
      {[](json& f) { f["views"][0]["world_from_camera"]["rotation"][0] = 9; }, "world_from_camera"},
      {[](json& f) { f["views"][0]["world_from_camera"]["translation_m"][0] = 1e9; }, "is more than 10000 m away"},
      {[&](json& f) { detection(f)["object"] = "../x"; }, "views[0].detections[0].object: the name of an object"},
      {[&](json& f) { detection(f)["track"] = 1.5; }, "views[0].detections[0].track: expected a whole number"},
      {[&](json& f) { detection(f)["score"] = 1.5; }, "views[0].detections[0].score: expected a number in [0, 1]"},
      {[&](json& f) { detection(f).erase("fit"); }, "views[0].detections[0].fit: expected a number in [0, 1]"},
      {[&](json& f) {
         detection(f)["uncertainty"] = {{"covariance", {1, 2}}};
       },
       "expected a covariance of 36 numbers"},
      {[&](json& f) { detection(f)["evidence"][1]["allowed"] = 1; }, "evidence[1].allowed: expected true or false"},
  };
  for (const auto& [change, message] : faults) {
    const std::string error = error_after("detections.json", change);
    EXPECT_THAT(error, HasSubstr(message));
    EXPECT_THAT(error, HasSubstr((folder_ / "detections.json").string() + ": "));
  }
}

TEST_F(ReadResults, ComparesTheFiles) {
  EXPECT_THAT(error_after("changes.json", [](json& f) { f["views"].erase(1); }),
              HasSubstr("changes.json: views: has fewer views than detections.json"));
  EXPECT_THAT(error_after("changes.json", [](json& f) { f["views"][0]["name"] = "x"; }),
              HasSubstr("views[0].name: differs from detections.json"));
  EXPECT_THAT(error_after("changes.json", [](json& f) { f["events"][0]["kind"] = "eaten"; }),
              HasSubstr("events[0].kind: is no kind of event"));
  EXPECT_THAT(error_after("changes.json", [](json& f) { f["events"][0]["view"] = 2; }),
              HasSubstr("events[0].view: is no view of detections.json"));
  fs::remove(folder_ / "changes.json");
  EXPECT_FALSE(read_recognition_results(folder_).ok());
}

TEST_F(ReadResults, NeedsNoSummary) {
  fs::remove(folder_ / "summary.json");
  const auto results = read_recognition_results(folder_);
  ASSERT_TRUE(results.ok());
  EXPECT_TRUE(results->sequence.empty() && results->models.empty());
}

TEST_F(ReadResults, SurvivesDamage) {
  std::ifstream in(folder_ / "detections.json");
  const std::string whole{std::istreambuf_iterator<char>(in), {}};
  Rng rng(1);
  int num_refused = 0;
  for (int i = 0; i < 300; ++i) {
    std::string bytes = whole;
    bytes[rng.below(static_cast<std::uint32_t>(bytes.size()))] = static_cast<char>(rng.below(256));
    if (i % 3 == 0) bytes.resize(rng.below(static_cast<std::uint32_t>(bytes.size())));
    store("detections.json", bytes);
    num_refused += read_recognition_results(folder_).ok() ? 0 : 1;
  }
  EXPECT_GT(num_refused, 100);
}

}  // namespace
}  // namespace resight
