// SPDX-License-Identifier: Apache-2.0
// What a run writes, and what is left of one that fails or is interrupted.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <fstream>
#include <regex>
#include <sstream>

#include "cli.hpp"
#include "resight/core/files.hpp"
#include "resight/core/printable.hpp"
#include "resight/io/sequence.hpp"
#include "resight/sensor/testing/ball_scene.hpp"

namespace resight::cli_test {
namespace {

/// Runs a script of the shell in a folder, and returns its status.
int run_script(const fs::path& folder, const std::string& script) {
  const int code = std::system(std::string("cd ").append(folder.string()).append(" && ").append(script).c_str());
  return WIFEXITED(code) ? WEXITSTATUS(code) : 128 + WTERMSIG(code);
}

TEST_F(CommandLineResults, TheReportIsTitledAfterTheSequence) {
  const Outcome outcome = run(folder_, "recognize --models models.resight --sequence views/ --out out");
  ASSERT_EQ(outcome.status, 0) << testing::PrintToString(outcome.errors);
  EXPECT_THAT(read_text(folder_ / "out/report.html"), testing::HasSubstr("<title>resight: views</title>"));
}

TEST_F(CommandLineResults, ResultsOfARunBeforeAreReplacedAndOtherFilesStay) {
  const std::string recognize = "recognize --models models.resight --sequence views --out out";
  EXPECT_EQ(run(folder_, recognize).status, 0);
  std::ofstream(folder_ / "out/mine.txt") << "mine";
  EXPECT_EQ(run(folder_, recognize).status, 0);
  EXPECT_EQ(read_text(folder_ / "out/mine.txt"), "mine");
  EXPECT_EQ(list(folder_ / "out").size(), 6U) << testing::PrintToString(list(folder_ / "out"));
}

TEST_F(CommandLineResults, ChangesOfOtherViewsGo) {
  EXPECT_EQ(run(folder_, "changes --sequence views --out out").status, 0);
  EXPECT_EQ(run(folder_, "changes --sequence views --max-views 2 --out out").status, 0);
  EXPECT_EQ(list(folder_ / "out").size(), 2 * 4 + 1U) << testing::PrintToString(list(folder_ / "out"));
}

TEST_F(CommandLineResults, ChangesRemoveOnlyTheirOwnFiles) {
  fs::rename(folder_ / "tuw/cloud_01.pcd", folder_ / "tuw/table_removed.pcd");
  ASSERT_EQ(run(folder_, kChangesTuw).status, 0);
  for (const char* end : {".png", "_novel.png", "_removed.png", ".ply"}) {
    EXPECT_TRUE(fs::exists(folder_ / "out/table_removed" += end)) << end;
    write_text(folder_ / "out/photo" += end, "mine");
  }
  const std::vector<std::string> before = list(folder_ / "out");
  ASSERT_EQ(run(folder_, kChangesTuw).status, 0);
  EXPECT_EQ(list(folder_ / "out"), before);
}

TEST_F(CommandLineResults, AnnotateWarnsAboutTheViews) {
  no_depth_at_all()(folder_);
  const Outcome outcome = run(folder_, "annotate --models nowhere --sequence views --out out --no-open");
  EXPECT_EQ(outcome.status, 2);
  EXPECT_THAT(outcome.errors, testing::ElementsAre(testing::HasSubstr("warning: only 0.0 % of the pixels have depth"),
                                                   testing::HasSubstr("nowhere")));
}

TEST_F(CommandLineResults, AnnotateBeginsNoProjectIfThePortIsTaken) {
  const int taken = ::socket(AF_INET, SOCK_STREAM, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t size = sizeof(address);
  ASSERT_EQ(::bind(taken, reinterpret_cast<sockaddr*>(&address), size), 0);
  ASSERT_EQ(::listen(taken, 1), 0);
  ASSERT_EQ(::getsockname(taken, reinterpret_cast<sockaddr*>(&address), &size), 0);
  const std::string port = std::to_string(ntohs(address.sin_port));
  const Outcome outcome =
      run(folder_, "annotate --models models.resight --sequence views --out out --no-open --port " + port);
  ::close(taken);
  EXPECT_EQ(outcome.status, 2);
  EXPECT_THAT(outcome.errors, testing::ElementsAre(testing::HasSubstr(port)));
  EXPECT_FALSE(fs::exists(folder_ / "out"));
}

TEST_F(CommandLineResults, ViewEndsIfNobodyLearnsItsAddress) {
  const int status = run_script(folder_, "timeout 20 " RESIGHT_PROGRAM " view views --no-open >/dev/full 2>errors");
  EXPECT_EQ(status, 1) << "124: it serves";
  EXPECT_THAT(read_text(folder_ / "errors"), testing::HasSubstr("the address could not be written"));
}

TEST_F(CommandLineResults, TrackWritesNoCloudWithoutDepth) {
  no_depth_at_all()(folder_);
  const Outcome outcome = run(folder_, "track --sequence views --poses refine --out poses.txt --fused cloud.ply");
  EXPECT_EQ(outcome.status, 2);
  ASSERT_FALSE(outcome.errors.empty());
  EXPECT_THAT(outcome.errors.back(), testing::HasSubstr("cloud.ply: is not written: the views have no depth"));
  EXPECT_FALSE(fs::exists(folder_ / "cloud.ply"));
}

TEST_F(CommandLineResults, TrainKeepsAFileThatCameMeanwhile) {
  const int status =
      run_script(folder_, "{ timeout 60 " RESIGHT_PROGRAM
                          " train meshes --out new.resight >output 2>errors & "
                          "until [ -s errors ]; do sleep 0.01; done; echo mine >new.resight; wait $!; }");
  EXPECT_EQ(status, 2);
  EXPECT_EQ(read_text(folder_ / "new.resight"), "mine\n");
}

TEST_F(CommandLineResults, AStreamHoldsTheViewsOfTheResults) {
  const Outcome outcome = run(folder_, "recognize --models models.resight --sequence views --out out --stream");
  ASSERT_EQ(outcome.status, 0) << testing::PrintToString(outcome.errors);
  std::istringstream lines(outcome.output);
  auto views = nlohmann::json::array();
  for (std::string line; std::getline(lines, line);) {
    views.push_back(nlohmann::json::parse(line));
    EXPECT_TRUE(views.back()["events"].is_array());
    views.back().erase("events");
  }
  EXPECT_EQ(views.size(), static_cast<std::size_t>(kViews));
  EXPECT_EQ(views, nlohmann::json::parse(read_text(folder_ / "out/detections.json"))["views"]);
}

TEST_F(CommandLineResults, TheNumberOfLiveViewsIsNoOptionOfTheFolder) {
  const std::string follow = "recognize --models models.resight --sequence views --every 2 --follow --max-views 1";
  ASSERT_EQ(run(folder_, follow + " --out out").status, 0);
  const Json summary = Json::parse(read_text(folder_ / "out/summary.json"));
  EXPECT_EQ(summary["inputs"]["sequence_options"], Json::array({"--every", "2"}));
}

TEST_F(CommandLineResults, ValuesThatAreNoFilesStayAsTheyAre) {
  write_text(folder_ / "2", "");
  write_text(folder_ / "fixed", "");
  ASSERT_EQ(run(folder_, std::string(kRecognize) + " --max-views 2 --poses fixed").status, 0);
  const Json summary = Json::parse(read_text(folder_ / "out/summary.json"));
  EXPECT_EQ(summary["inputs"]["sequence_options"], Json::array({"--max-views", "2", "--poses", "fixed"}));
  EXPECT_EQ(summary["settings"]["poses.fixed"], "true");
}

TEST_F(CommandLineResults, ATraceBelongsToItsRunAndChangesNothing) {
  const auto detections = [&] {
    EXPECT_EQ(run(folder_, kRecognize).status, 0);
    return read_text(folder_ / "out/detections.json");
  };
  const std::string without = detections();
  ASSERT_EQ(run(folder_, "recognize --models models.resight --sequence views --out out --trace").status, 0);
  EXPECT_EQ(read_text(folder_ / "out/detections.json"), without);
  std::istringstream lines(read_text(folder_ / "out/trace.jsonl"));
  std::string line;
  std::getline(lines, line);
  EXPECT_EQ(nlohmann::json::parse(line)["format"], "resight trace 2");
  int num_views = 0;
  for (; std::getline(lines, line); ++num_views) EXPECT_EQ(nlohmann::json::parse(line)["view"], num_views);
  EXPECT_EQ(num_views, kViews);
  EXPECT_EQ(detections(), without);
  EXPECT_FALSE(fs::exists(folder_ / "out/trace.jsonl")) << "it would be taken for one of the new run";
}

TEST_F(CommandLineResults, ATraceStaysIfNewResultsCannotTakeItsPlace) {
  ASSERT_EQ(run(folder_, "recognize --models models.resight --sequence views --out out --trace").status, 0);
  const std::string before = read_text(folder_ / "out/trace.jsonl");
  ASSERT_FALSE(before.empty());
  // While the program waits for more views, a folder takes the place of a file.
  EXPECT_EQ(
      run_script(folder_,
                 "{ " RESIGHT_PROGRAM
                 " recognize --models models.resight --sequence views --out out --follow >told 2>&1 </dev/null & } "
                 "&& for i in $(seq 600); do [ -s out/finished_views.jsonl ] && break; sleep 0.1; done; "
                 "rm out/summary.json; mkdir out/summary.json; kill -TERM $!; wait $!"),
      2);
  EXPECT_THAT(read_text(folder_ / "told"), testing::HasSubstr("is a folder where a file is to be written"));
  EXPECT_EQ(read_text(folder_ / "out/trace.jsonl"), before);
}

TEST_F(CommandLineResults, FinishedViewsAreKeptUntilTheResultsReplaceThem) {
  const std::string depth = read_text(folder_ / "views/depth/000002.png");
  write_text(folder_ / "views/depth/000002.png", "cut o");
  EXPECT_EQ(run(folder_, kRecognize).status, 2);
  EXPECT_EQ(list(folder_ / "out").size(), 1U) << testing::PrintToString(list(folder_ / "out"));
  std::istringstream lines(read_text(folder_ / "out/finished_views.jsonl"));
  auto views = nlohmann::json::array();
  for (std::string line; std::getline(lines, line);) {
    views.push_back(nlohmann::json::parse(line));
    views.back().erase("events");
  }
  write_text(folder_ / "views/depth/000002.png", depth);
  EXPECT_EQ(run(folder_, kRecognize).status, 0);
  EXPECT_FALSE(fs::exists(folder_ / "out/finished_views.jsonl"));
  auto all = nlohmann::json::parse(read_text(folder_ / "out/detections.json"))["views"];
  all.erase(2);
  EXPECT_EQ(views, all);
}

TEST_F(CommandLineResults, AFolderIsWrittenByOneCommandAtATime) {
  const auto other = PendingDirectory::create(folder_ / "out", ExistingFolder::kFill);
  ASSERT_TRUE(other.ok());
  for (const char* command : {kConvert, kRecognize, kChanges, kEvaluate, "demo --out out"}) {
    const Outcome outcome = run(folder_, command);
    EXPECT_EQ(outcome.status, 2) << command;
    EXPECT_THAT(testing::PrintToString(outcome.errors), testing::HasSubstr("another command is writing it")) << command;
  }
  EXPECT_TRUE(fs::is_empty(other->path()));
  EXPECT_FALSE(fs::exists(folder_ / "out")) << "evaluated before it was refused";
}

TEST_F(CommandLineResults, AnInterruptedDemoLeavesNothing) {
  const std::vector<std::string> before = list(folder_);
  for (const int signal : {SIGTERM, SIGHUP}) {
    EXPECT_EQ(run_script(folder_, "{ " RESIGHT_PROGRAM
                                  " demo --out out >../demo.out 2>&1 </dev/null & } && for i in $(seq 600); do "
                                  "find . -path '*out*models_info.json' | grep -q . && break; sleep 0.1; done; kill -" +
                                      std::to_string(signal) + " $!; wait $!"),
              128 + signal);
    EXPECT_EQ(list(folder_), before);
  }
}

TEST_F(CommandLineResults, AClosedPipeEndsTheProgramAndLeavesOnlyFinishedViews) {
  const std::string command = "cd " + folder_.string() + " && { " RESIGHT_PROGRAM " " + kRecognize +
                              " --stream 2>/dev/null; echo $? >status; } | true";
  ASSERT_EQ(std::system(command.c_str()), 0);
  EXPECT_EQ(read_text(folder_ / "status"), std::to_string(128 + SIGPIPE) + "\n");
  EXPECT_THAT(list(folder_), testing::Not(testing::Contains(testing::HasSubstr("resight-partial"))));
  EXPECT_FALSE(fs::exists(folder_ / "out/summary.json"));
}

TEST_F(CommandLineResults, OutputThatIsLostIsAnError) {
  const std::string command = "cd " + folder_.string() + " && " RESIGHT_PROGRAM " options >/dev/full 2>errors";
  EXPECT_EQ(WEXITSTATUS(std::system(command.c_str())), 1);
  EXPECT_THAT(read_text(folder_ / "errors"), testing::HasSubstr("resight: the output could not be written"));
}

TEST_F(CommandLineResults, TrainingChecksEveryInputBeforeItBegins) {
  write_text(folder_ / "meshes/z.ply", "ply\n");
  EXPECT_EQ(run(folder_, kTrain).status, 2);
  EXPECT_THAT(read_text(folder_.string() + ".stderr"), testing::Not(testing::HasSubstr("train 1/2")));
}

TEST_F(CommandLineResults, VeryManyKeysAreNoResults) {
  std::string keys = "\"version\": 1";
  for (int i = 0; i < 200000; ++i) keys += ", \"" + std::to_string(i) + "\": {\"" + std::to_string(i) + "\": 1}";
  write_text(folder_ / "many/summary.json", "{" + keys + "}");
  EXPECT_EQ(run(folder_, "info many").status, 2);
  write_text(folder_ / "deep/summary.json", "{\"version\": 1, \"times\": {" + keys + "}}");
  const Outcome deep = run(folder_, "info deep --json");
  EXPECT_EQ(deep.status, 0);
  EXPECT_EQ(Json::parse(deep.output)["version"], 1);
}

TEST_F(CommandLineResults, LongListsOfResultsTakeLittleTime) {
  std::string items = "{}";
  for (int i = 0; i < 400000; ++i) items += ",{}";
  write_text(folder_ / "long/summary.json", R"({"a": 1, "b": [)" + items + R"(], "c": "x", "d": {"e": 2}})");
  const Outcome outcome = run(folder_, "info long --json");
  ASSERT_EQ(outcome.status, 0);
  EXPECT_EQ(Json::parse(outcome.output), (Json{{"path", "long"}, {"kind", "results"}, {"a", 1}, {"c", "x"}}));
}

TEST_F(CommandLineResults, TrueChangesAreThoseOfAllViews) {
  write_text(folder_ / "tum/events.json", R"({"events": [[1, "added", "cube"]]})");
  const std::string poses = read_text(folder_ / "tum/groundtruth.txt");
  write_text(folder_ / "all.txt", poses);
  write_text(folder_ / "two.txt", poses.substr(poses.find('\n') + 1));
  EXPECT_EQ(run(folder_, "convert tum all --to bop --poses all.txt").status, 0);
  EXPECT_TRUE(fs::exists(folder_ / "all/events.json"));
  const Outcome two = run(folder_, "convert tum two --to bop --poses two.txt");
  EXPECT_EQ(two.status, 0);
  EXPECT_THAT(two.errors, testing::Contains(testing::HasSubstr("the true changes are left out")));
  EXPECT_FALSE(fs::exists(folder_ / "two/events.json"));
}

TEST_F(CommandLineResults, JsonOnTheTerminalKeepsAllNames) {
  const std::string name = "v\xE2\x80\xAE\x7F";
  fs::rename(folder_ / "views", folder_ / name);
  for (const std::string command : {"info ", "check "}) {
    const Json json = Json::parse(run(folder_, command + name + " --json").output, nullptr, false);
    ASSERT_TRUE(json.is_object()) << command;
    EXPECT_EQ(json["path"], name) << command;
  }
  const std::string view = "cloud_\xE2\x80\xAE\x7F_01";
  fs::rename(folder_ / "tuw/cloud_01.pcd", folder_ / "tuw" / (view + ".pcd"));
  std::istringstream lines(run(folder_, std::string(kRecognizeTuw) + " --stream").output);
  std::vector<std::string> views;
  for (std::string line; std::getline(lines, line);) {
    const Json json = Json::parse(line, nullptr, false);
    ASSERT_TRUE(json.is_object()) << line;
    views.push_back(json["name"]);
  }
  EXPECT_THAT(views, testing::Contains(view));
}

TEST_F(CommandLineResults, TrainingFindsEmptyMasksBeforeItBegins) {
  copy("tuw/cloud_01.pcd", "meshes/z/views/cloud_01.pcd")(folder_);
  write_text(folder_ / "meshes/z/views/pose_01.txt", "1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n");
  write_text(folder_ / "meshes/z/views/object_indices_01.txt", "");
  const Outcome outcome = run(folder_, kTrain);
  EXPECT_EQ(outcome.status, 2);
  EXPECT_THAT(
      outcome.errors,
      testing::ElementsAre(testing::HasSubstr("meshes/z: model 'z': the masks of all training views are empty")));
  EXPECT_THAT(read_text(folder_.string() + ".stderr"), testing::Not(testing::HasSubstr("train 1/2")));
}

TEST_F(CommandLineResults, ModelsAreCheckedBeforeTheFirstIsRendered) {
  const auto expect_early_refusal = [&](const char* line) {
    const Outcome outcome = run(folder_, "convert meshes out --to tuw");
    EXPECT_EQ(outcome.status, 2);
    EXPECT_THAT(outcome.errors, testing::ElementsAre(testing::HasSubstr(line)));
    EXPECT_THAT(read_text(folder_.string() + ".stderr"), testing::Not(testing::HasSubstr("convert 1/2")));
  };
  write_text(folder_ / "meshes/z.ply", "ply\n");
  expect_early_refusal("z.ply: ");
  fs::remove(folder_ / "meshes/z.ply");
  write_text(folder_ / "meshes/z.pcd", kUnorganizedPcd);
  expect_early_refusal("z.pcd: is a cloud without views");
}

TEST_F(CommandLineResults, NamesThatAreNotUtf8AreNoObstacle) {
  fs::rename(folder_ / "views", folder_ / "v\xff");
  EXPECT_EQ(
      run(folder_, "evaluate --models models.resight --dataset v$(printf '\\377') --presets mvr -k 0 --out out").status,
      0);
  EXPECT_TRUE(fs::exists(folder_ / "out/worst.md"));
}

TEST_F(CommandLineResults, NamesDoNotControlTheTerminal) {
  // Colours, a forged line, a deleted character, a cleared screen, and text from right to left.
  const std::string evil =
      "evil\x1b[31m\r\nforged\x7F\xC2\x9B"
      "2J\xE2\x80\xAE";
  for (const char* name : {"views", "tuw", "tum", "meshes", "empty"})
    fs::rename(folder_ / name, folder_ / (evil + name));
  for (const char* view : {"cloud_00.pcd", "cloud_01.pcd", "cloud_02.pcd"})
    fs::rename(folder_ / (evil + "tuw") / view, folder_ / (evil + "tuw") / (evil + view));
  fs::create_directory(folder_ / "bad");
  fs::copy(folder_ / (evil + "meshes") / "cube.ply", folder_ / "bad" / (evil + "cube.ply"));
  const std::string below = " \"$(printf %s evil*empty)\"/";
  const std::string recognize = "recognize --models models.resight --out" + below + "recognized --sequence ";
  const std::string evaluate =
      "evaluate --models models.resight --presets mvr -k 0 --out" + below + "evaluated --dataset ";
  const std::pair<std::string, int> commands[] = {
      {recognize + "evil*tuw", 0},
      {recognize + "evil*tuw --stream", 0},
      {recognize + "evil*views --follow --max-views 1", 0},
      {recognize + "evil*empty", 2},
      {evaluate + "evil*views", 0},
      {evaluate + "evil*empty", 2},
      {"track --sequence evil*tuw --out" + below + "poses.txt", 2},
      {"track --sequence evil*tum --out evil*views", 2},
      {"train evil*meshes --out" + below + "new.resight", 0},
      {"train bad --out new.resight", 2},
      {"train evil*empty --out new.resight", 2},
      {"changes --sequence evil*tuw --out" + below + "changes", 0},
      {"check evil*tuw", 0},
      {"check evil*tuw --json", 0},
      {"info evil*tuw", 0},
      {"info models.resight", 0},
      {"info evil*meshes", 0},
      {"convert evil*tuw" + below + "bop --to bop", 0},
      {"convert evil*meshes" + below + "models --to bop", 0},
      {"model --sequence evil*tuw --out" + below + "model", 2},
      {"evil*tuw", 2},
      {"info models.resight evil*tuw", 2},
      {"simulate evil*empty --out new", 2},
  };
  for (const auto& [command, status] : commands) {
    EXPECT_EQ(run(folder_, command).status, status) << command;
    for (const char* stream : {".stdout", ".stderr"}) {
      std::istringstream lines(read_text(folder_.string() + stream));
      for (std::string line; std::getline(lines, line);) {
        EXPECT_EQ(printable(line), line) << command;
        EXPECT_FALSE(line.starts_with("forged")) << command;
      }
    }
  }
}

TEST_F(CommandLineResults, SequencesOfTheSameNameAreEvaluatedApart) {
  copy("views", "set/kitchen/views")(folder_);
  copy("views", "set/office/views")(folder_);
  copy("views", "set/desk")(folder_);
  const Outcome outcome = run(folder_, "evaluate --models models.resight --dataset set --presets mvr -k 0 --out out");
  ASSERT_EQ(outcome.status, 0) << testing::PrintToString(outcome.errors);
  std::vector<std::string> runs;
  for (const auto& entry : fs::directory_iterator(folder_ / "out/runs"))
    runs.push_back(entry.path().filename().string());
  EXPECT_THAT(
      runs, testing::UnorderedElementsAre("desk.mvr.k0.json", "kitchen_views.mvr.k0.json", "office_views.mvr.k0.json"));
}

TEST_F(CommandLineResults, AStoredRunOfOtherViewsOrObjectsIsComputedAgain) {
  ASSERT_EQ(run(folder_, kEvaluate).status, 0);
  const fs::path file = folder_ / "out/runs/views.mvr.k0.json";
  const Json good = Json::parse(read_text(file));
  const auto replace_run = [&](const Json& stored) {
    write_text(file, stored.dump());
    EXPECT_EQ(run(folder_, kEvaluate).status, 0);
    EXPECT_EQ(Json::parse(read_text(file))["views"].size(), good["views"].size());
    EXPECT_THAT(read_text(file), testing::Not(testing::HasSubstr("strange")));
  };
  Json more_views = good;  // The last one would be among the worst.
  more_views["views"].push_back(good["views"][0]);
  more_views["views"].back()["score"] = {0, 9, 9};
  replace_run(more_views);
  Json other_object = good;
  other_object["views"][0]["score"] = {0, 9, 9};
  const Json detection = {{"object", "strange"},
                          {"camera_from_object", {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 1}},
                          {"score", 0.5},
                          {"verdict", "false positive"}};
  other_object["views"][0]["detections"] = Json::array({detection});
  replace_run(other_object);
  Json other_preset = good;
  other_preset["preset"] = "strange";
  replace_run(other_preset);
}

TEST_F(CommandLineResults, FindingsInTheSequenceAreReplaced) {
  no_depth_at_all()(folder_);
  for (int i = 0; i < 2; ++i) {
    const Outcome outcome = run(folder_, "check views --out views/pictures --json");
    EXPECT_EQ(outcome.status, 1) << testing::PrintToString(outcome.errors);
    EXPECT_TRUE(fs::exists(folder_ / "views/pictures/no_depth.png"));
    EXPECT_EQ(read_text(folder_ / "views/pictures/findings.json"), outcome.output);
  }
  fs::copy(root_ / "good/views/depth", folder_ / "views/depth",
           fs::copy_options::recursive | fs::copy_options::overwrite_existing);
  EXPECT_EQ(run(folder_, "check views --out views/pictures").status, 0);
  const Json report = Json::parse(read_text(folder_ / "views/pictures/findings.json"));
  EXPECT_EQ(report["findings"], Json::array()) << "the picture would pass for one of this check";
}

TEST_F(CommandLineResults, TheAdvisedDepthBiasReplacesAGivenOne) {
  const auto writer = create_sequence(folder_ / "biased", DatasetFormat::kBop);
  ASSERT_TRUE(writer.ok()) << writer.error().message;
  for (const RgbdFrame& frame : test::render_biased_views(0.02)) ASSERT_TRUE((*writer)->write_view(frame, {}).ok());
  ASSERT_TRUE((*writer)->finish().ok());
  const std::string output = run(folder_, "check biased --depth-bias 0.03").output;
  std::smatch advised;
  ASSERT_TRUE(std::regex_search(output, advised, std::regex("--depth-bias (-?[0-9.]+)"))) << output;
  EXPECT_NEAR(std::stod(advised[1]), 0.02, 0.004);
}

TEST_F(CommandLineResults, NoSecretAddressIsLeftBehindBySignals) {
  fs::create_directory(folder_ / "tmp");
  // A desktop without a browser.
  EXPECT_EQ(
      run_script(folder_,
                 "{ TMPDIR=$PWD/tmp DISPLAY=:0 PATH=/nowhere " RESIGHT_PROGRAM
                 " view views >told 2>&1 </dev/null & } && for i in $(seq 600); do [ -s tmp/resight-view-*.html ] "
                 "&& break; sleep 0.1; done; cat tmp/* >seen; kill -PIPE $!; wait $!"),
      128 + SIGPIPE)
      << read_text(folder_ / "told");
  EXPECT_THAT(read_text(folder_ / "seen"), testing::HasSubstr("#token="));
  EXPECT_EQ(list(folder_ / "tmp"), std::vector<std::string>{});
}

TEST_F(CommandLineResults, ViewPrintsItsAddressAndEndsWhenInterrupted) {
  ASSERT_EQ(run(folder_, "recognize --models models.resight --sequence views --out out").status, 0);
  for (const char* input : {"out", "views", "models.resight", "meshes"}) {
    // Interrupted only after it has told its address: a busy machine may take seconds to start it.
    const std::string command = "cd " + folder_.string() + " && rm -f told && { " RESIGHT_PROGRAM " view --no-open " +
                                std::string(input) +
                                " >told 2>&1 </dev/null & } && for i in $(seq 600); do grep -q Ctrl-C told && break; "
                                "sleep 0.1; done; kill -INT $!; wait $!";
    EXPECT_EQ(std::system(command.c_str()), 0) << input;
    EXPECT_TRUE(std::regex_match(read_text(folder_ / "told"),
                                 std::regex("http://127\\.0\\.0\\.1:[0-9]+/#token=[0-9a-f]{32}\n.*Ctrl-C.*\n")))
        << input << ": " << read_text(folder_ / "told");
  }
}

}  // namespace
}  // namespace resight::cli_test
