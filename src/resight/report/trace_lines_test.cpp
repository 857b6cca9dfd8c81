// SPDX-License-Identifier: Apache-2.0
#include "resight/report/trace_lines.hpp"

#include <gmock/gmock.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <functional>
#include <nlohmann/json.hpp>

#include "resight/io/recognition_results.hpp"
#include "resight/report/report_test_scene.hpp"
#include "resight/report/results.hpp"

namespace resight {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using test::at;
using testing::HasSubstr;

/// A view with a ball that was accepted, a slab that was rejected, a ball that another one suppresses, and a big ball
/// that the changes exclude. The slab is there and is missed.
class TraceLines : public testing::Test {
 protected:
  TraceLines() : frame_(test::make_frame()), library_(test::make_library()) {
    frame_.world_from_camera = Rigid3::identity();
    update_.view = 4;
    update_.view_name = "view4";
    update_.counts = {.correspondences = 9, .generated = 8, .merged = 7, .clustered = 4, .accepted = 1};
    add(1, at(0.2, 0, 1), Verdict::kNoSupport, 0.5);
    add(0, at(0, 0, 1), Verdict::kAccepted, 0.9);
    add(0, at(0.01, 0, 1), Verdict::kSuppressed, 0.8);
    trace_.evidence[2].suppressed_by = 1;
    trace_.clustered.push_back(make(2, at(0, 0.3, 1)));
    Detection detection = test::make_detection(frame_, 0, at(0, 0, 1));
    detection.hypothesis_id = 1;
    update_.detections.push_back(detection);
    missed_.push_back({"slab", 12, 0, at(0.21, 0, 1), 0.6});
  }
  [[nodiscard]] Hypothesis make(int object, const Rigid3& pose) const {
    Hypothesis h;
    h.id = trace_.clustered.size();
    h.object = object;
    h.world_from_object = pose;
    h.origin_views = {2, 4};
    return h;
  }
  void add(int object, const Rigid3& pose, Verdict verdict, double fit) {
    trace_.clustered.push_back(make(object, pose));
    trace_.verified.push_back(trace_.clustered.back());
    HypothesisEvidence e;
    e.accepted = verdict == Verdict::kAccepted;
    e.verdict = verdict;
    e.world_from_object = pose * at(0.001, 0, 0);
    e.fit = fit;
    e.num_visible = 100;
    e.visible_share = 0.4;
    e.num_explained = 55;
    e.explained_share = 0.55;
    e.visible_share_per_view = {0.25F, 0.5F};
    e.explained_share_per_view = {0.5F, 0.625F};
    trace_.evidence.push_back(e);
  }
  [[nodiscard]] std::string line() const {
    const TracedView view{.update = &update_, .trace = &trace_, .missed = missed_, .acceptance = &acceptance_};
    return format_trace_line(view, library_);
  }
  RgbdFrame frame_;
  ModelLibrary library_;
  SceneUpdate update_;
  RecognitionTrace trace_;
  std::vector<GroundTruthObject> missed_;
  AcceptanceOptions acceptance_;
};

TEST_F(TraceLines, SayWhyEachHypothesisWasRejected) {
  const json view = json::parse(line());
  ASSERT_EQ(view["hypotheses"].size(), 4U);
  const json& accepted = view["hypotheses"][0];
  EXPECT_EQ(accepted["verdict"], "accepted");
  EXPECT_EQ(accepted["test"], nullptr);
  const json& slab = view["hypotheses"][1];
  EXPECT_EQ(slab["object"], "slab") << "a missed object was lost with it, so that it comes before what fits better";
  EXPECT_EQ(slab["verdict"], "no support");
  EXPECT_EQ(slab["test"]["quantity"], "explained share");
  EXPECT_EQ(slab["test"]["value"], 0.55);
  EXPECT_EQ(slab["test"]["limit"], 0.7);
  EXPECT_EQ(slab["views"][1]["view"], 4) << "the window ends with this view";
  EXPECT_EQ(view["hypotheses"][2]["verdict"], "suppressed");
  EXPECT_EQ(view["hypotheses"][2]["suppressed_by"], 0) << "its number in the list";
  EXPECT_EQ(view["hypotheses"][2]["test"], nullptr);
  EXPECT_EQ(view["hypotheses"][3]["verdict"], "not verified");
  ASSERT_EQ(view["lost"].size(), 1U);
  EXPECT_EQ(view["lost"][0]["stage"], "rejected");
  EXPECT_EQ(view["lost"][0]["hypothesis"], 1);
  EXPECT_NEAR(view["lost"][0]["center_error_m"], 0.009, 1e-6);
}

TEST_F(TraceLines, SayWhatWasAcceptedButNotReported) {
  update_.detections.clear();
  EXPECT_EQ(json::parse(line())["hypotheses"][0]["verdict"], "held back");
}

TEST_F(TraceLines, ListABoundedNumberOfHypotheses) {
  for (int i = 0; i < 1000; ++i) add(2, at(1e-7 * i, 0.123456789, 1), Verdict::kCost, 0.001 * i);
  const std::string text = line();
  EXPECT_LT(text.size(), 250000U);
  const json hypotheses = json::parse(text)["hypotheses"];
  ASSERT_EQ(hypotheses.size(), kMaxTracedHypotheses);
  EXPECT_EQ(hypotheses[0]["verdict"], "accepted");
  EXPECT_EQ(hypotheses[1]["object"], "slab");
  EXPECT_EQ(hypotheses[2]["fit"], 0.999);
}

class StoredTraces : public TraceLines {
 protected:
  StoredTraces() {
    update_.view = 0;  // whose window is this view alone
    for (HypothesisEvidence& e : trace_.evidence) {
      e.visible_share_per_view = {0.5F};
      e.explained_share_per_view = {0.625F};
    }
    folder_ = fs::temp_directory_path() / ("resight_trace_test_" + std::to_string(::getpid()));
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  ~StoredTraces() override { fs::remove_all(folder_); }
  void store(const std::string& text) const { std::ofstream(folder_ / kTraceFile) << text; }
  [[nodiscard]] std::string header() const { return format_trace_header("default", "1.2.3") + "\n"; }
  /// What is wrong with the only line after a change.
  [[nodiscard]] std::string error_after(const std::function<void(json&)>& change) const {
    json view = json::parse(line());
    change(view);
    store(header() + view.dump() + "\n");
    const auto trace = TraceFile::open(folder_ / kTraceFile, 1);
    EXPECT_TRUE(trace.ok());
    const auto read = trace->read(0, "view4");
    return read.ok() ? "none" : read.error().message;
  }
  fs::path folder_;
};

TEST_F(StoredTraces, AreReadBack) {
  store(header() + line() + "\n");
  const auto file = TraceFile::open(folder_ / kTraceFile, 1);
  ASSERT_TRUE(file.ok()) << file.error().message;
  const auto trace = file->read(0, "view4");
  ASSERT_TRUE(trace.ok()) << trace.error().message;
  EXPECT_EQ(trace->num_merged, 7);
  ASSERT_EQ(trace->hypotheses.size(), 4U);
  const StoredHypothesis& slab = trace->hypotheses[1];
  EXPECT_EQ(slab.object, "slab");
  EXPECT_THAT(slab.origin_views, testing::ElementsAre(2, 4));
  EXPECT_NEAR(slab.start.translation.x(), 0.2, 1e-7);
  ASSERT_TRUE(slab.verification.has_value());
  EXPECT_NEAR(slab.verification->world_from_object.translation.x(), 0.201, 1e-7);
  EXPECT_EQ(slab.verification->failed_test->quantity, "explained share");
  ASSERT_EQ(slab.verification->views.size(), 1U);
  EXPECT_EQ(slab.verification->views[0].explained_share, 0.625);
  EXPECT_EQ(trace->hypotheses[2].verification->suppressed_by, 0);
  EXPECT_FALSE(trace->hypotheses[3].verification.has_value());
  ASSERT_EQ(trace->lost.size(), 1U);
  EXPECT_EQ(trace->lost[0].stage, "rejected");
  EXPECT_EQ(trace->lost[0].hypothesis, 1);
}

TEST_F(StoredTraces, AreFollowedWhileTheyAreWritten) {
  TraceFile trace = TraceFile::follow(folder_ / kTraceFile);
  EXPECT_FALSE(trace.find_new_views().ok()) << "there is no file yet";
  store(header());
  ASSERT_TRUE(trace.find_new_views().ok());
  EXPECT_EQ(trace.num_views(), 0);
  EXPECT_FALSE(trace.read(0, "view4").ok()) << "not written yet";
  store(header() + line() + "\n" + line().substr(0, 40));
  ASSERT_TRUE(trace.find_new_views().ok());
  EXPECT_EQ(trace.num_views(), 1) << "a line that is not whole does not count";
  EXPECT_TRUE(trace.read(0, "view4").ok());
  json second = json::parse(line());
  second["view"] = 1;
  store(header() + line() + "\n" + second.dump() + "\n");
  ASSERT_TRUE(trace.find_new_views().ok());
  EXPECT_EQ(trace.num_views(), 2);
  const auto read = trace.read(1, "view4");
  EXPECT_TRUE(read.ok()) << read.error().message;
  fs::rename(folder_ / kTraceFile, folder_ / "complete.jsonl");
  EXPECT_TRUE(trace.read(1, "view4").ok()) << "a file that is complete goes to its place";
  EXPECT_TRUE(trace.find_new_views().ok());
  fs::resize_file(folder_ / "complete.jsonl", 0);
  EXPECT_FALSE(trace.find_new_views().ok()) << "the file was cut";
  EXPECT_FALSE(trace.read(1, "view4").ok());
}

TEST_F(StoredTraces, BelongToTheirResults) {
  ASSERT_TRUE(write_results(folder_, test::make_run(), library_).ok());
  store(header() + line() + "\n");
  const auto results = read_recognition_results(folder_);
  ASSERT_FALSE(results.ok()) << "the run has more views";
  EXPECT_THAT(results.error().message, HasSubstr("traces 1 views, but the results have"));
  store("once upon a time\n");
  EXPECT_THAT(read_recognition_results(folder_).error().message, HasSubstr("is no trace of"));
  fs::remove(folder_ / kTraceFile);
  ASSERT_TRUE(read_recognition_results(folder_).ok());
  EXPECT_FALSE(read_recognition_results(folder_)->trace.has_value());
}

// Each line takes memory, whatever its length.
TEST_F(StoredTraces, MayNotHaveMoreLinesThanViews) {
  const auto error_of = [&](const std::string& text) {
    store(text);
    const auto trace = TraceFile::open(folder_ / kTraceFile, 2);
    return trace.ok() ? std::string("none") : trace.error().message;
  };
  EXPECT_EQ(error_of(header() + "x\nx\n"), "none");
  EXPECT_THAT(error_of(header() + "x\nx\nx\nx\n"), HasSubstr("traces more views than the results have (2)"));
  EXPECT_THAT(error_of(header() + "x\n\nx\n"), HasSubstr("line 3 is empty"));
  EXPECT_THAT(error_of(std::string(100, '\n')), HasSubstr("is no trace of"));
}

TEST_F(StoredTraces, AreCheckedWhenTheyAreRead) {
  EXPECT_EQ(error_after([](json&) {}), "none");
  EXPECT_THAT(error_after([](json& j) { j["name"] = "view5"; }), HasSubstr("line 2.view: is not that of the results"));
  EXPECT_THAT(error_after([](json& j) { j["hypotheses"][0]["fit"] = 1.5; }), HasSubstr("hypotheses[0].fit"));
  EXPECT_THAT(error_after([](json& j) { j["hypotheses"][2]["suppressed_by"] = 4; }), HasSubstr("is out of range"));
  EXPECT_THAT(error_after([](json& j) { j["hypotheses"][0]["start"]["rotation"][0] = 7; }), HasSubstr("not a rigid"));
  EXPECT_THAT(error_after([](json& j) { j["lost"][0]["object"] = "../slab"; }), HasSubstr("lost[0].object"));
  EXPECT_THAT(error_after([](json& j) { j.erase("searched"); }), HasSubstr("searched: expected true or false"));
  store(header() + "{\"view\":0\n");
  EXPECT_FALSE(TraceFile::open(folder_ / kTraceFile, 1)->read(0, "view4").ok());
}

}  // namespace
}  // namespace resight
