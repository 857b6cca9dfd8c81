// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "resight/annotation/annotated_scene_test.hpp"
#include "resight/viewer/http_test_client.hpp"
#include "resight/viewer/viewer_routes.hpp"

namespace resight {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using test::body_of;
using test::status_of;
using testing::HasSubstr;

const std::string kSecret = "fedcba9876543210fedcba9876543210";

json pose_numbers(const Rigid3& pose) {
  const Eigen::Matrix4d matrix = pose.matrix();
  return std::vector<double>(matrix.data(), matrix.data() + matrix.size());
}
Rigid3 pose_of(const json& numbers) {
  const auto values = numbers.get<std::vector<double>>();
  EXPECT_EQ(values.size(), 16U);
  return Rigid3::from_matrix(Eigen::Map<const Eigen::Matrix4d>(values.data()));
}

/// A project of a simulated scene with one proposed region, behind a real server. The scene is made once.
class AnnotationRoutes : public testing::Test {
 protected:
  static void SetUpTestSuite() { scene_ = std::make_shared<test::AnnotatedScene>(); }
  static void TearDownTestSuite() { scene_.reset(); }
  AnnotationRoutes()
      : folder_(fs::temp_directory_path() / ("resight_annotation_routes_" + std::to_string(::getpid()))) {
    fs::remove_all(folder_);
    ViewerScene shown;
    shown.sequence = scene_;
    shown.library = library();
    shown.is_annotated = true;
    data_ = SceneData::create(std::move(shown)).value();
    service_ = std::make_unique<AnnotationService>(make_task());
    server_ = std::make_unique<test::RunningServer>(make_viewer_handler(*data_, kSecret, service_.get()));
  }
  ~AnnotationRoutes() override {
    server_.reset();
    fs::remove_all(folder_);
  }
  static std::shared_ptr<const ModelLibrary> library() {
    return {std::shared_ptr<const ModelLibrary>(), &scene_->library};
  }
  [[nodiscard]] AnnotationTask make_task() const {
    AnnotationTask task;
    task.sequence = scene_;
    task.library = library();
    ChangeProposal region;
    region.view = 3;
    region.box.world_from_box = Rigid3::from_translation({0.25, -0.5, 0.75});
    region.box.size_m = {0.1, 0.1, 0.1};
    region.pixels = {{100, 5}, {420, 6}};
    task.regions.push_back(region);
    const AnnotationLimits limits{.num_views = scene_->num_views(),
                                  .num_objects = static_cast<int>(scene_->library.objects.size())};
    task.project = AnnotationProject::open(folder_ / "project", limits, "test").value();
    task.scene_name = "small";
    task.export_folder = folder_ / "export";
    return task;
  }

  [[nodiscard]] std::string send(const std::string& method, const std::string& path, const std::string& body,
                                 const std::string& token = kSecret, const std::string& host = "localhost:1") const {
    return server_->ask(method + " /api/annotation" + path + " HTTP/1.1\r\nHost: " + host + "\r\nX-Resight-Token: " +
                        token + "\r\nContent-Length: " + std::to_string(body.size()) + "\r\n\r\n" + body);
  }
  [[nodiscard]] std::string post(const std::string& path, const json& body) const {
    return send("POST", path, body.dump());
  }
  [[nodiscard]] json ask(const std::string& method, const std::string& path, const json& body = {}) const {
    const std::string answer = send(method, path, body.is_null() ? "" : body.dump());
    EXPECT_EQ(status_of(answer), 200) << path << ": " << answer.substr(0, 500);
    return json::parse(body_of(answer), nullptr, false);
  }
  [[nodiscard]] json get(const std::string& path) const { return ask("GET", path); }
  /// A change based on the current revision.
  [[nodiscard]] json edit(const json& change) const {
    return {{"revision", get("")["revision"]}, {"action", {{"title", "t"}, {"changes", {change}}}}};
  }
  [[nodiscard]] json put_first() const {
    const AnnotatedObject& object = scene_->document.objects.begin()->second;
    return {{"do", "put_object"},
            {"id", -1},
            {"track", -1},
            {"object", object.object},
            {"first_view", 0},
            {"last_view", 2},
            {"pose", pose_numbers(object.world_from_object)}};
  }

  static std::shared_ptr<test::AnnotatedScene> scene_;
  fs::path folder_;
  std::unique_ptr<SceneData> data_;
  std::unique_ptr<AnnotationService> service_;
  std::unique_ptr<test::RunningServer> server_;
};
std::shared_ptr<test::AnnotatedScene> AnnotationRoutes::scene_;

TEST_F(AnnotationRoutes, ActionsChangeTheStateAndAnswerIt) {
  EXPECT_EQ(get("")["objects"].size(), 0U);
  const json put = ask("POST", "/actions", edit(put_first()));
  EXPECT_EQ(put["revision"], 1);
  ASSERT_EQ(put["objects"].size(), 1U);
  EXPECT_EQ(put["objects"][0]["id"], 0);
  EXPECT_EQ(put["undo"], "t");
  const json undone = ask("POST", "/actions", {{"revision", 1}, {"action", "undo"}});
  EXPECT_EQ(undone["objects"].size(), 0U);
  EXPECT_EQ(undone["redo"], "t");
  EXPECT_EQ(ask("POST", "/actions", {{"revision", 2}, {"action", "redo"}})["objects"].size(), 1U);
  EXPECT_EQ(get("/views/1")["detections"].size(), 1U);
  EXPECT_FALSE(get("/views/1")["detections"][0]["outline"].empty());
  EXPECT_EQ(get("/views/1")["detections"][0]["id"], 0);
  EXPECT_EQ(get("/views/4")["detections"].size(), 0U) << "the placement has ended";
}

TEST_F(AnnotationRoutes, RegionsAreJudgedAndCorrected) {
  const json open = get("")["regions"][0];
  EXPECT_EQ(open["verdict"], "open");
  EXPECT_EQ(get("/regions/0"), json::parse(R"({"proposed":[100,5,420,6],"corrected":null})"));
  const json judgement = {{"do", "judge_region"}, {"region", open["key"]}, {"verdict", "accepted"}, {"mask", {7, 3}}};
  const json judged = ask("POST", "/actions", edit(judgement))["regions"][0];
  EXPECT_EQ(judged["verdict"], "accepted");
  EXPECT_EQ(judged["is_corrected"], true);
  EXPECT_EQ(get("/regions/0")["corrected"], json::parse("[7,3]"));
  const json lost = {{"do", "judge_region"},
                     {"region", {{"view", 1}, {"kind", "removed"}, {"center", {0, 0, 0}}}},
                     {"verdict", "rejected"}};
  const json to_dos = ask("POST", "/actions", edit(lost))["to_dos"];
  ASSERT_EQ(to_dos.size(), 1U);
  EXPECT_EQ(to_dos[0]["kind"], "lost_region");
  EXPECT_EQ(to_dos[0]["lost"]["view"], 1);
}

TEST_F(AnnotationRoutes, PosesAreFoundFittedAndAssessed) {
  const AnnotatedObject& object = scene_->document.objects.begin()->second;
  const ObjectModel& model = scene_->library.objects[static_cast<std::size_t>(object.object)];
  const Eigen::Vector3d center = object.world_from_object * model.center.cast<double>();
  const RgbdFrame& frame = scene_->frames[0];
  const Eigen::Vector2d pixel = frame.camera.project(frame.world_from_camera.inverse() * center);
  const json click = {{"object", object.object},
                      {"view", 0},
                      {"u", static_cast<int>(std::lround(pixel.x()))},
                      {"v", static_cast<int>(std::lround(pixel.y()))}};
  const json placed = ask("POST", "/place", click)["pose"];
  EXPECT_LT((pose_of(placed) * model.center.cast<double>() - center).norm(), 0.05);
  const json refined = ask("POST", "/refine",
                           {{"object", object.object},
                            {"pose", pose_numbers(Rigid3::from_translation({0.004, 0, 0}) * object.world_from_object)},
                            {"first_view", 0},
                            {"last_view", 2}});
  EXPECT_LT((pose_of(refined["pose"]) * model.center.cast<double>() - center).norm(), 0.002);
  EXPECT_EQ(refined["views"].size(), 3U);
  EXPECT_GT(refined["num_pairs"], 100);
  const json assessed =
      ask("POST", "/assess", {{"object", object.object}, {"pose", pose_numbers(object.world_from_object)}});
  ASSERT_EQ(assessed.size(), 6U);
  EXPECT_EQ(assessed[0]["is_gone"], false);
  EXPECT_EQ(assessed[5]["is_gone"], true);
  const json some = ask("POST", "/assess",
                        {{"object", object.object},
                         {"pose", pose_numbers(object.world_from_object)},
                         {"first_view", 3},
                         {"last_view", 4}});
  EXPECT_EQ(some, json::array({assessed[3], assessed[4]}));
  EXPECT_TRUE(get("/symmetries/0").is_array());
}

TEST_F(AnnotationRoutes, TheExportIsWrittenOnce) {
  (void)ask("POST", "/actions", edit(put_first()));
  EXPECT_EQ(ask("POST", "/export", json::object())["folder"], (folder_ / "export").string());
  const auto written = fs::last_write_time(folder_ / "export" / "bop" / "small" / "scene_gt.json");
  (void)ask("POST", "/export", json::object());
  EXPECT_EQ(fs::last_write_time(folder_ / "export" / "bop" / "small" / "scene_gt.json"), written);
  fs::remove_all(folder_ / "export");
  fs::create_directories(folder_ / "export");
  std::ofstream(folder_ / "export" / "thesis.tex") << "text";
  (void)ask("POST", "/actions", {{"revision", 1}, {"action", "undo"}});
  const std::string refused = post("/export", json::object());
  EXPECT_EQ(status_of(refused), 500);
  EXPECT_THAT(body_of(refused), HasSubstr("is no earlier export"));
}

TEST_F(AnnotationRoutes, EveryRouteNeedsTokenAndHost) {
  for (const char* path : {"", "/views/0", "/symmetries/0", "/regions/0", "/nothing"}) {
    EXPECT_EQ(status_of(send("GET", path, "", "")), 403) << path;
    EXPECT_EQ(status_of(send("GET", path, "", kSecret, "evil.example")), 403) << path;
  }
  for (const char* path : {"/actions", "/place", "/refine", "/assess", "/export", "/nothing"}) {
    EXPECT_EQ(status_of(send("POST", path, "{}", kSecret.substr(1))), 403) << path;
    EXPECT_EQ(status_of(send("POST", path, "{}", kSecret, "evil.example:1")), 403) << path;
  }
  for (const char* method : {"PUT", "DELETE", "PATCH", "OPTIONS"}) {
    const std::string refused = send(method, "/actions", "{}");
    EXPECT_EQ(status_of(refused), 405) << method;
    EXPECT_THAT(refused, HasSubstr("Allow: GET, POST")) << method;
  }
  EXPECT_FALSE(fs::exists(folder_ / "export")) << "nothing was exported";
}

TEST_F(AnnotationRoutes, UnknownAddressesAreNotFound) {
  for (const char* path :
       {"/views/6", "/views/-1", "/views/", "/views", "/views/0/color", "/symmetries/99", "/symmetries/x", "/regions/1",
        "/regions/0x0", "/regions", "/actions", "/export", "/../scene"})
    EXPECT_EQ(status_of(send("GET", path, "")), 404) << path;
  for (const char* path : {"", "/", "/views/0", "/regions/0", "/actions/0", "/Actions", "/export/../actions"})
    EXPECT_EQ(status_of(send("POST", path, "{}")), 404) << path;
}

TEST_F(AnnotationRoutes, BodiesThatAreNoObjectsAreRefused) {
  const std::string deep = std::string(500000, '[') + std::string(500000, ']');
  for (const char* path : {"/actions", "/place", "/refine", "/assess", "/export"}) {
    for (const std::string& body : {std::string(), std::string("{"), std::string("[]"), std::string("7"),
                                    std::string("\"{}\""), std::string("{\"a\":1}}"), std::string("\xff\xfe{}"), deep})
      EXPECT_EQ(status_of(send("POST", path, body)), 400) << path << " " << body.substr(0, 20);
    EXPECT_EQ(status_of(send("POST", path, "{\"a\":\"" + std::string(1100000, 'x') + "\"}")), 413) << path;
  }
  EXPECT_EQ(get("")["revision"], 0);
}

TEST_F(AnnotationRoutes, NestingInAnActionDoesNotOverflowTheStack) {
  const std::string lists = std::string(400000, '[') + std::string(400000, ']');
  EXPECT_EQ(status_of(send("POST", "/actions", R"({"revision":0,"action":)" + lists + "}")), 400);
  const json title = {{"revision", 0},
                      {"action", {{"title", std::string(100, '[') + "\\\""}, {"changes", json::array()}}}};
  EXPECT_EQ(status_of(post("/actions", title)),
            status_of(post("/actions", {{"revision", 0}, {"action", {{"title", "t"}, {"changes", json::array()}}}})))
      << "brackets in strings are no nesting";
}

TEST_F(AnnotationRoutes, WrongValuesAreRefusedAndChangeNothing) {
  const json pose = pose_numbers(Rigid3::from_translation({0, 0, 1}));
  const std::string key = R"({"view":3,"kind":"novel","center":[0,0,0]})";
  const auto judge = [&](const std::string& rest) { return json::parse(R"({"do":"judge_region",)" + rest + "}"); };
  for (const json& change :
       {json::parse(R"({"do":"drop_object","id":9})"), json::parse(R"({"do":"check_view","view":6,"is_checked":true})"),
        json{{"do", "put_object"}, {"object", 99}, {"first_view", 0}, {"last_view", 1}, {"pose", pose}},
        json{{"do", "put_object"}, {"object", 0}, {"first_view", 0}, {"last_view", 6}, {"pose", pose}},
        json{{"do", "put_object"}, {"object", 0}, {"first_view", 2}, {"last_view", 1}, {"pose", pose}},
        judge(R"("region":0,"verdict":"accepted")"), judge("\"region\":" + key + ",\"verdict\":\"perhaps\""),
        judge("\"region\":" + key + ",\"verdict\":\"open\",\"mask\":[5,3,4,1]"),
        judge("\"region\":" + key + ",\"verdict\":\"open\",\"mask\":[0,99999999]"),
        judge(R"("region":{"view":6,"kind":"novel","center":[0,0,0]},"verdict":"accepted")"),
        json::parse(R"({"do":"put_event","view":0,"kind":"added","name":"x","after":[0,0,0]})")})
    EXPECT_EQ(status_of(post("/actions", edit(change))), 400) << change;
  for (const json& body : {json{{"revision", 0}}, json{{"action", "undo"}}, json{{"revision", "0"}, {"action", "undo"}},
                           json{{"revision", 0}, {"action", "redo"}}, json{{"revision", 0}, {"action", "stop"}}})
    EXPECT_EQ(status_of(post("/actions", body)), 400) << body;
  for (const json& revision : {json(-1), json(1), json(1LL << 40)})
    EXPECT_EQ(status_of(post("/actions", {{"revision", revision}, {"action", "undo"}})), 409) << revision;
  EXPECT_EQ(get("")["revision"], 0);
  for (const json& body :
       {json{{"object", 0}}, json{{"object", 0}, {"view", 0}, {"u", 320}, {"v", 0}},
        json{{"object", 0}, {"view", 6}, {"u", 0}, {"v", 0}}, json{{"object", -1}, {"view", 0}, {"u", 0}, {"v", 0}},
        json{{"object", 0}, {"view", 0}, {"u", 0.5}, {"v", 0}}})
    EXPECT_EQ(status_of(post("/place", body)), 400) << body;
  for (const json& body : {json{{"object", 0}, {"pose", pose}, {"first_view", 2}, {"last_view", 1}},
                           json{{"object", 0}, {"pose", {1, 2}}, {"first_view", 0}, {"last_view", 1}},
                           json{{"object", 99}, {"pose", pose}, {"first_view", 0}, {"last_view", 1}}}) {
    EXPECT_EQ(status_of(post("/refine", body)), 400) << body;
    EXPECT_EQ(status_of(post("/assess", body)), 400) << body;
  }
}

}  // namespace
}  // namespace resight
