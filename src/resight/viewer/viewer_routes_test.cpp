// SPDX-License-Identifier: Apache-2.0
#include "resight/viewer/viewer_routes.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>

#include "resight/io/ply.hpp"
#include "resight/viewer/http_test_client.hpp"

namespace resight {
namespace {

using nlohmann::json;
using test::body_of;
using test::status_of;

constexpr int kNumViews = 3;
const std::string kToken = "0123456789abcdef0123456789abcdef";

/// Views of a wall. View 2 cannot be read.
class WallSequence : public Sequence {
 public:
  [[nodiscard]] std::string format() const override { return "test"; }
  [[nodiscard]] int num_views() const override { return kNumViews; }
  [[nodiscard]] std::string view_name(int view) const override { return "view_" + std::to_string(view); }
  [[nodiscard]] Result<RgbdFrame> read_view(int view) const override {
    ++num_reads;
    if (view == 2) return Error{"view_2.png: is damaged"};
    RgbdFrame frame;
    frame.name = view_name(view);
    frame.camera = {64, 48, 60, 60, 31.5, 23.5};
    frame.color = Image<Rgb8>(64, 48, Rgb8{200, 100, 50});
    frame.depth_m = Image<float>(64, 48, 1.5F);
    frame.depth_m(3, 0) = std::numeric_limits<float>::quiet_NaN();
    return frame;
  }
  [[nodiscard]] Result<Rigid3> read_pose(int) const override { return Rigid3(); }
  [[nodiscard]] bool has_ground_truth() const override { return true; }
  [[nodiscard]] Result<std::vector<GroundTruthObject>> read_ground_truth(int) const override {
    return std::vector<GroundTruthObject>{{"ball", 1, 0, Rigid3::from_translation({0, 0, 1}), 0.75}};
  }
  mutable int num_reads = 0;
};

std::shared_ptr<const ModelLibrary> make_ball_library() {
  auto library = std::make_shared<ModelLibrary>();
  ObjectModel ball;
  ball.name = "ball";
  ball.bop_id = 1;
  for (int i = 0; i < 2000; ++i) {
    const double z = 1 - (2 * i + 1) / 2000.0;
    const double angle = 2.39996 * i;
    const Eigen::Vector3d direction(std::sqrt(1 - z * z) * std::cos(angle), std::sqrt(1 - z * z) * std::sin(angle), z);
    ball.surface.points.emplace_back((0.1 * direction).cast<float>());
    ball.surface.normals.emplace_back(direction.cast<float>());
  }
  library->objects.push_back(ball);
  library->surface_voxel_m = 0.01F;
  return library;
}

ViewerRun make_run(const std::string& name) {
  ViewerRun run{name, {}};
  run.results.preset = "default";
  for (int v = 0; v < 2; ++v) {
    StoredView view;
    view.name = "view_" + std::to_string(v);
    StoredDetection detection;
    detection.object = v == 0 ? "ball" : "unknown <thing>";
    detection.track = 4;
    detection.score = 0.875;
    detection.world_from_object = Rigid3::from_translation({0.01, 0, 1});
    detection.evidence.push_back({0, true, 0.5, std::numeric_limits<double>::quiet_NaN(), 0});
    view.detections.push_back(detection);
    run.results.views.push_back(view);
  }
  run.results.events.push_back({1, "moved", "ball", 4, Rigid3(), Rigid3::from_translation({0, 0, 1}), 0.5});
  return run;
}

ViewerScene make_scene() {
  ViewerScene scene;
  scene.title = "a table";
  scene.sequence = std::make_shared<WallSequence>();
  scene.library = make_ball_library();
  scene.runs = {make_run("first"), make_run("second")};
  return scene;
}

class ViewerRoutes : public testing::Test {
 protected:
  ViewerRoutes() : scene_(SceneData::create(make_scene()).value()), server_(make_viewer_handler(*scene_, kToken)) {}
  [[nodiscard]] std::string get(const std::string& path, const std::string& token = kToken,
                                const std::string& host = "127.0.0.1:4000") const {
    return server_.ask("GET " + path + " HTTP/1.1\r\nHost: " + host + "\r\nX-Resight-Token: " + token + "\r\n\r\n");
  }
  [[nodiscard]] json get_json(const std::string& path) const {
    const std::string answer = get(path);
    EXPECT_EQ(status_of(answer), 200) << answer;
    return json::parse(body_of(answer));
  }
  std::unique_ptr<SceneData> scene_;
  test::RunningServer server_;
};

TEST_F(ViewerRoutes, ServesThePageWithoutToken) {
  for (const char* path : {"/", "/viewer.js", "/viewer.css", "/icon.svg", "/licenses.txt"}) {
    const std::string answer = get(path, "");
    EXPECT_EQ(status_of(answer), 200) << path;
    EXPECT_FALSE(body_of(answer).empty()) << path;
    EXPECT_EQ(answer.find(kToken), answer.npos);
  }
}

TEST_F(ViewerRoutes, NeedsTheTokenAndALoopbackHost) {
  for (const char* path : {"/api/scene", "/api/events", "/api/views/0", "/api/views/0/color", "/api/views/0/depth",
                           "/api/surfaces/0", "/api/nothing"}) {
    EXPECT_EQ(status_of(get(path, "")), 403) << path;
    EXPECT_EQ(status_of(get(path, kToken + "0")), 403) << path;
    EXPECT_EQ(status_of(get(path, kToken, "evil.example:4000")), 403) << path;
  }
  EXPECT_EQ(status_of(get("/", kToken, "evil.example")), 403);
  EXPECT_EQ(status_of(server_.ask("GET /api/scene HTTP/1.0\r\n\r\n")), 403) << "no host at all";
  // Nothing is written, so that a body of any kind is refused.
  EXPECT_EQ(status_of(server_.ask("POST /api/scene HTTP/1.1\r\nHost: localhost\r\nX-Resight-Token: " + kToken +
                                  "\r\nContent-Length: 2\r\n\r\n{]")),
            405);
}

TEST_F(ViewerRoutes, FindsDataByNumberOnly) {
  for (const char* path : {"/api/views/3",
                           "/api/views/-1",
                           "/api/views/+1",
                           "/api/views/0x0",
                           "/api/views/",
                           "/api/views",
                           "/api/views/99999999999999999999",
                           "/api/views/0/color/",
                           "/api/views/0/../1",
                           "/api/views/0?run=2",
                           "/api/views/0?run=",
                           "/api/views/0/trace",
                           "/api/views/0/trace?run=2",
                           "/api/views/3/trace?run=0",
                           "/api/surfaces/2",
                           "/api",
                           "/api/../viewer.js",
                           "/../../etc/passwd",
                           "/..%2f..%2fetc/passwd",
                           "//etc/passwd",
                           "/viewer.js/",
                           "/%00",
                           "/index.html"})
    EXPECT_EQ(status_of(get(path)), 404) << path;
}

TEST_F(ViewerRoutes, DescribesTheScene) {
  const json index = get_json("/api/scene");
  EXPECT_EQ(index["title"], "a table");
  ASSERT_EQ(index["views"].size(), 3U);
  EXPECT_EQ(index["views"][1]["name"], "view_1");
  ASSERT_EQ(index["objects"].size(), 2U);
  EXPECT_EQ(index["objects"][0]["has_surface"], true);
  EXPECT_EQ(index["objects"][1]["name"], "unknown <thing>");
  EXPECT_EQ(index["objects"][1]["has_surface"], false);
  ASSERT_EQ(index["runs"].size(), 2U);
  const json& run = index["runs"][1];
  EXPECT_EQ(run["views"][0]["detections"][0]["object"], 0);
  EXPECT_EQ(run["views"][0]["detections"][0]["pose"][12], 0.01) << "column by column";
  EXPECT_EQ(run["views"][2], nullptr) << "not recognised";
  EXPECT_EQ(run["events"][0]["kind"], "moved");
}

TEST_F(ViewerRoutes, DescribesAView) {
  const json view = get_json("/api/views/0?run=1");
  EXPECT_EQ(view["camera"]["fx"], 60);
  ASSERT_EQ(view["detections"].size(), 1U);
  const json& outline = view["detections"][0]["outline"];
  ASSERT_EQ(outline.size(), 1U);
  int right = 0;  // the ball: radius 60 px * 0.1 m / 1 m, at 0.01 m
  for (std::size_t i = 0; i < outline[0].size(); i += 2) right = std::max(right, outline[0][i].get<int>());
  EXPECT_NEAR(right, 38, 1);
  EXPECT_EQ(view["detections"][0]["evidence"][0]["explained_share"], nullptr);
  ASSERT_EQ(view["truth"].size(), 1U);
  EXPECT_EQ(view["truth"][0]["object"], 0);
  EXPECT_EQ(get_json("/api/views/1")["detections"].size(), 0U) << "without a run";
  EXPECT_EQ(get_json("/api/views/1?run=0")["detections"][0]["outline"].size(), 0U) << "an object without a model";
}

/// A scene whose only run has left out view 0, so that view 1 is the first one of its results.
ViewerScene make_scene_with_gap() {
  ViewerScene scene = make_scene();
  scene.runs = {make_run("gap")};
  RecognitionResults& results = scene.runs[0].results;
  results.views.erase(results.views.begin());
  results.views[0].detections[0].evidence.push_back({7, true, 0.5, 0.5, 0.5});
  results.events[0].view = 0;
  return scene;
}

TEST(SceneData, NumbersViewsAsTheSequenceDoes) {
  const auto data = SceneData::create(make_scene_with_gap()).value();
  EXPECT_EQ(json::parse(**data->index())["runs"][0]["events"][0]["view"], 1);
  const json evidence = json::parse(**data->view(1, 0))["detections"][0]["evidence"];
  ASSERT_EQ(evidence.size(), 2U);
  EXPECT_EQ(evidence[0]["view"], 1);
  EXPECT_EQ(evidence[1]["view"], -1) << "no view of the results";
}

TEST(SceneData, ComparesWithTheTruthAtTheCentreAndUpToSymmetry) {
  ViewerScene scene = make_scene();
  ModelLibrary library = *scene.library;
  library.objects[0].center = {0.05F, 0, 0};
  library.objects[0].symmetries.continuous.push_back({Eigen::Vector3d::UnitZ(), {0.05, 0, 0}});
  scene.library = std::make_shared<const ModelLibrary>(library);
  // The true pose, turned by 90 degrees about the axis of symmetry, which lies beside the origin.
  Rigid3 turn = Rigid3::from_axis_angle(Eigen::Vector3d::UnitZ(), std::acos(0.0));
  turn.translation = {0.05, -0.05, 0};
  scene.runs[0].results.views[0].detections[0].world_from_object = Rigid3::from_translation({0, 0, 1}) * turn;
  const auto data = SceneData::create(std::move(scene)).value();
  const json error = json::parse(**data->view(0, 0))["detections"][0]["truth_error"];
  EXPECT_NEAR(error["center_distance_m"].get<double>(), 0, 1e-6);
  EXPECT_NEAR(error["rotation_rad"].get<double>(), 0, 1e-6);
  const json other = json::parse(**data->view(0, 1))["detections"][0]["truth_error"];
  EXPECT_NEAR(other["center_distance_m"].get<double>(), 0.01, 1e-6);
  EXPECT_EQ(json::parse(**data->view(1, 0))["detections"][0]["truth_error"], nullptr) << "no true pose of the object";
}

TEST_F(ViewerRoutes, SendsImagesDepthAndSurfaces) {
  const std::string color = get("/api/views/0/color");
  EXPECT_NE(color.find("Content-Type: image/jpeg"), color.npos);
  EXPECT_TRUE(body_of(color).starts_with("\xff\xd8"));
  const std::string depth = body_of(get("/api/views/0/depth"));
  ASSERT_EQ(depth.size(), 64U * 48U * 4U);
  float values[4];
  std::memcpy(values, depth.data(), sizeof(values));
  EXPECT_EQ(values[0], 1.5F);
  EXPECT_TRUE(std::isnan(values[3]));
  const std::string surface = body_of(get("/api/surfaces/0"));
  ASSERT_EQ(surface.size(), 8U + 2000U * (12U + 3U));
  std::uint32_t header[2];
  std::memcpy(header, surface.data(), sizeof(header));
  EXPECT_EQ(header[0], 2000U);
  EXPECT_EQ(header[1], 1U) << "normals, no colours";
}

TEST_F(ViewerRoutes, ReportsWhatCannotBeRead) {
  const std::string answer = get("/api/views/2/color");
  EXPECT_EQ(status_of(answer), 500);
  EXPECT_EQ(body_of(answer), "view_2.png: is damaged");
  EXPECT_EQ(body_of(get("/api/surfaces/1")), "unknown <thing>: has no model");
}

TEST(SceneData, ReadsTheChangesOfAView) {
  const auto folder = std::filesystem::temp_directory_path() / ("resight_viewer_test_" + std::to_string(::getpid()));
  PointCloud cloud;
  cloud.points.emplace_back(1, 2, 3);
  cloud.colors.push_back({220, 30, 30});
  ASSERT_TRUE(write_ply(folder / "view_0.ply", cloud).ok());
  ViewerScene scene = make_scene();
  scene.changes = folder;
  const auto data = SceneData::create(std::move(scene)).value();
  const test::RunningServer server(make_viewer_handler(*data, kToken));
  const auto get = [&](const std::string& path) {
    return server.ask("GET " + path + " HTTP/1.1\r\nHost: localhost\r\nX-Resight-Token: " + kToken + "\r\n\r\n");
  };
  EXPECT_EQ(body_of(get("/api/views/0/changes")).size(), 8U + 12U + 3U);
  EXPECT_EQ(status_of(get("/api/views/1/changes")), 500) << "this view has none";
  std::filesystem::remove_all(folder);
}

constexpr const char* kTrace = R"({"format":"resight trace 2"}
{"view":0,"name":"view_0","searched":true,"generated":3,"merged":2,"clustered":1,"hypotheses":[{"object":"ball",)"
                               R"("verdict":"not verified","origin_views":[0],"correspondences":7,"start":)"
                               R"({"rotation":[1,0,0,0,1,0,0,0,1],"translation_m":[0,0,1]}}],"lost":[]}
{"view":1,"name":"view_1"}
)";

TEST(SceneData, SaysWhatBecameOfTheHypotheses) {
  const auto file = std::filesystem::temp_directory_path() / ("resight_viewer_trace_" + std::to_string(::getpid()));
  std::ofstream(file) << kTrace;
  ViewerScene scene = make_scene();
  scene.runs[1].results.trace = TraceFile::open(file, 2).value();
  const auto data = SceneData::create(std::move(scene)).value();
  const json index = json::parse(**data->index());
  EXPECT_EQ(index["runs"][0]["has_trace"], false);
  EXPECT_EQ(index["runs"][1]["has_trace"], true);
  const test::RunningServer server(make_viewer_handler(*data, kToken));
  const auto get = [&](const std::string& path) {
    return server.ask("GET " + path + " HTTP/1.1\r\nHost: localhost\r\nX-Resight-Token: " + kToken + "\r\n\r\n");
  };
  const json trace = json::parse(body_of(get("/api/views/0/trace?run=1")));
  ASSERT_EQ(trace["hypotheses"].size(), 1U);
  EXPECT_EQ(trace["hypotheses"][0]["object"], 0);
  EXPECT_EQ(trace["hypotheses"][0]["pose"][14], 1);
  EXPECT_EQ(trace["hypotheses"][0]["verification"], nullptr);
  EXPECT_EQ(trace["num_merged"], 2);
  const std::string damaged = get("/api/views/1/trace?run=1");
  EXPECT_EQ(status_of(damaged), 500);
  EXPECT_NE(body_of(damaged).find("line 3.searched"), damaged.npos) << damaged;
  EXPECT_EQ(json::parse(body_of(get("/api/views/2/trace?run=1")))["hypotheses"].size(), 0U) << "not recognised";
  EXPECT_EQ(json::parse(body_of(get("/api/views/0/trace?run=0")))["hypotheses"].size(), 0U) << "not traced";
  std::filesystem::remove(file);
}

TEST(SceneData, NumbersTheViewsOfATraceAsTheSequenceDoes) {
  const auto file = std::filesystem::temp_directory_path() / ("resight_gap_trace_" + std::to_string(::getpid()));
  std::string lines = kTrace;
  lines.resize(lines.find("{\"view\":1"));
  lines[lines.find("view_0") + 5] = '1';  // the name of the view: it is the first one of the results
  std::ofstream(file) << lines;
  ViewerScene scene = make_scene_with_gap();
  scene.runs[0].results.trace = TraceFile::open(file, 1).value();
  const auto data = SceneData::create(std::move(scene)).value();
  const json trace = json::parse(**data->trace(1, 0));
  ASSERT_EQ(trace["hypotheses"].size(), 1U);
  EXPECT_EQ(trace["hypotheses"][0]["origin_views"], json::parse("[1]"));
  std::filesystem::remove(file);
}

TEST(SceneData, SaysWhatBecameOfTheHypothesesWhileViewsAreRecognised) {
  const auto file = std::filesystem::temp_directory_path() / ("resight_live_trace_" + std::to_string(::getpid()));
  ViewerScene scene = make_scene();
  const ViewerRun whole = make_run("live");
  scene.runs = {ViewerRun{"live", {}}};
  scene.runs[0].results.trace = TraceFile::follow(file);
  scene.is_live = true;
  const auto data = SceneData::create(std::move(scene)).value();
  EXPECT_EQ(json::parse(**data->index())["runs"][0]["has_trace"], true);
  EXPECT_EQ(json::parse(**data->trace(0, 0))["hypotheses"].size(), 0U) << "not recognised yet";
  EXPECT_FALSE(data->add_view(whole.results.views[0], {}).ok()) << "its line was not written";
  std::ofstream(file) << kTrace;
  ASSERT_TRUE(data->add_view(whole.results.views[0], {}).ok());
  EXPECT_EQ(json::parse(**data->trace(0, 0))["hypotheses"].size(), 1U);
  std::filesystem::remove(file);
}

TEST(SceneData, MakesEachThingOnce) {
  ViewerScene scene = make_scene();
  const auto sequence = std::make_shared<WallSequence>();
  scene.sequence = sequence;
  const auto data = SceneData::create(std::move(scene)).value();
  EXPECT_EQ(sequence->num_reads, 0) << "opens without reading views";
  const auto first = data->color(0);
  ASSERT_TRUE(data->depth(0).ok() && data->view(0, 0).ok());
  EXPECT_EQ(sequence->num_reads, 1);
  EXPECT_EQ(*data->color(0), *first) << "the same bytes, not a copy";
}

TEST(SceneData, RefusesResultsOfAnotherSequence) {
  ViewerScene scene = make_scene();
  scene.runs[1].results.views[1].name = "other";
  const auto data = SceneData::create(std::move(scene));
  ASSERT_FALSE(data.ok());
  EXPECT_EQ(data.error().message, "second: the sequence has no view 'other' (another sequence was recognised)");
}

TEST(SceneData, TakesViewsWhileTheyAreRecognised) {
  ViewerScene scene = make_scene();
  scene.runs = {ViewerRun{"live", {}}};
  scene.is_live = true;
  const auto data = SceneData::create(std::move(scene)).value();
  EXPECT_EQ(json::parse(**data->index())["runs"][0]["views"][1], nullptr);
  const ViewerRun whole = make_run("live");
  ASSERT_TRUE(data->add_view(whole.results.views[0], {}).ok());
  ASSERT_TRUE(data->add_view(whole.results.views[1], whole.results.events).ok());
  EXPECT_EQ(data->revision(), 2);
  const json index = json::parse(**data->index());
  EXPECT_EQ(index["is_live"], true);
  EXPECT_EQ(index["runs"][0]["views"][1]["detections"][0]["object"], 1);
  EXPECT_EQ(index["runs"][0]["events"].size(), 1U);
  data->finish({});
  EXPECT_EQ(json::parse(**data->index())["is_live"], false);
  EXPECT_EQ(json::parse(**data->index())["runs"][0]["events"].size(), 0U);
}

TEST(ByteCache, DropsWhatWasUsedLongestAgo) {
  ByteCache cache(10);
  const auto bytes = [](std::size_t count) { return std::make_shared<const std::string>(count, 'x'); };
  cache.add("a", bytes(4));
  cache.add("b", bytes(4));
  EXPECT_TRUE(cache.find("a"));
  cache.add("c", bytes(4));
  EXPECT_TRUE(cache.find("a"));
  EXPECT_FALSE(cache.find("b"));
  cache.add("huge", bytes(11));
  EXPECT_FALSE(cache.find("huge"));
  EXPECT_LE(cache.num_bytes(), 10U);
}

}  // namespace
}  // namespace resight
