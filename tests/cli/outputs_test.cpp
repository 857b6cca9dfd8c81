// SPDX-License-Identifier: Apache-2.0
// Where results may be written.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "cli.hpp"

namespace resight::cli_test {
namespace {

const std::string kTrainToLongName = "train meshes --out " + kLongName;

constexpr const char* kTrackedPoses =
    "# world_from_camera of 3 of 3 views\n000000 0 0 0 0 0 0 1\n000001 0 0 0 0 0 0 1\n000002 0 0 0 0 0 0 1\n";

constexpr const char* kOurs = "{\n \"version\": \"0.2.0\"}";  // Results begin like this.
constexpr const char* kEvaluate = "evaluate --models models.resight --dataset views -k 0 --out out";

const Row kOutputRows[] = {
    // Output paths.
    {"RecognizeBelowAFile", kNothing, "recognize --models models.resight --sequence views --out file/out", 2,
     "file/out: "},
    {"RecognizeOntoAFile", kNothing, "recognize --models models.resight --sequence views --out file", 2,
     "file: exists already and is not a folder"},
    {"ChangesBelowAFile", kNothing, "changes --sequence views --out file/out", 2, "file/out: "},
    {"EvaluateBelowAFile", kNothing, "evaluate --models models.resight --dataset views -k 0 --out file/out", 2,
     "file is not a folder"},
    {"TrainBelowAFile", kNothing, "train meshes --out file/new.resight", 2, "file is not a folder"},
    {"TrainOntoAFolder", kNothing, "train meshes --out empty", 2, "empty: is a folder"},
    {"TrainOverItsInput", kNothing, "train meshes/cube.ply --out meshes/cube.ply", 2, "cube\\.ply: is an input"},
    {"TrainBehindAMissingFolder", kNothing, "train meshes --out missing/../file", 2,
     "missing/\\.\\./file: cannot be written \\(it leads through a folder that does not exist\\)"},
    {"TrainOverALinkToAnEmptyFile", both(write("e", ""), link("l", "e")), "train meshes --out l", 2,
     "l: exists already and is no model library"},
    {"TrainOverAForeignFile", kNothing, "train meshes --out file", 2, "file: exists already and is no model library"},
    {"TrainOverALink", link("dangling", "nowhere"), "train meshes --out dangling", 2,
     "dangling is a link that leads nowhere"},
    {"TrainOverALibrary", kNothing, "train meshes --out models.resight", 0, "", "models.resight"},
    {"TrainToALongName", kNothing, kTrainToLongName.c_str(), 2, "name is too long"},
    {"TrackOverTheSequence", kNothing, "track --sequence views --out views/scene_camera.json", 2,
     "scene_camera\\.json: exists already"},
    {"TrackBesideAForeignJournal", write("poses.txt.partial", "notes\n"), "track --sequence views --out poses.txt", 2,
     "poses\\.txt\\.partial: exists already"},
    {"TrackOverItsPoses", write("poses.txt", kTrackedPoses), "track --sequence views --poses poses.txt --out poses.txt",
     2, "poses\\.txt: is an input"},
    {"TrackOverItsPosesWithAComponent", write("poses_component1.txt", kTrackedPoses),
     "track --sequence views --poses poses_component1.txt --out poses.txt", 2, "poses_component1\\.txt: is an input"},
    {"TrackOverItsIntrinsics", write("poses.txt", "# world_from_camera of mine\n60 60 31.5 23.5\n"),
     "track --sequence tum --intrinsics poses.txt --out poses.txt", 2, "poses\\.txt: is an input"},
    {"TrackOverAForeignComponent", write("poses_component2.txt", "mine\n"), "track --sequence views --out poses.txt", 2,
     "poses_component2\\.txt: exists already"},
    {"TrackWithAPictureOverAnImage", kNothing, "track --sequence views --out poses.txt --fused views/rgb/000000.ply", 2,
     "000000\\.png: exists already"},
    {"TrackWithAForeignCloud", write("cloud.ply", "ply\nformat ascii 1.0\n"),
     "track --sequence views --out poses.txt --fused cloud.ply", 2, "cloud\\.ply: exists already"},
    {"TrackIntoTheNewSequence", kNothing, "track --sequence views --out new/poses.txt --write-sequence new", 2,
     "new/poses\\.txt: lies below another output"},
    {"TrackBelowItsPoses", kNothing, "track --sequence views --out new --write-sequence new/views", 2,
     "new/views: lies below another output"},
    {"TrackToOneNameTwice", kNothing, "track --sequence views --out a.ply --fused full/../a.ply", 2,
     "a\\.ply: would be written twice"},
    {"TrackOverItsPicture", kNothing, "track --sequence views --out a.png --fused a.ply", 2,
     "a\\.png: would be written twice"},
    {"TrackOverItsObjects", kNothing,
     "track --sequence views --models models.resight --out a.ply --fused a_objects.ply", 2,
     "a_objects\\.ply: would be written twice"},
    {"TrackOverAFurtherComponent", kNothing, "track --sequence views --out a.ply --fused a_component2.ply", 2,
     "a_component2\\.ply: would be written twice"},
    {"TrackOverItsJournal", kNothing, "track --sequence views --out a --write-sequence a.partial", 2,
     "a\\.partial: would be written twice"},
    {"TrackOverForeignObjects", write("poses_objects.txt", "mine\n"),
     "track --sequence views --out poses.txt --models models.resight", 2, "poses_objects\\.txt: exists already"},
    {"RecognizeIntoTheSequence", kNothing, "recognize --models models.resight --sequence views --out views", 2,
     "views: is an input"},
    {"ChangesOverTheImages", kNothing, "changes --sequence views --out views/rgb", 2,
     "views/rgb: holds files that are no results of 'resight changes'"},
    {"ChangesOverImagesOfAnotherSequence", copy("views/rgb", "other/rgb"), "changes --sequence views --out other/rgb",
     2, "other/rgb: holds files that are no results"},
    {"ChangesBesideForeignFiles", write("out/notes.txt", ""), kChanges, 2, "out: holds files that are no results"},
    {"ChangesOverForeignChanges", write("out/changes.json", "{}"), kChanges, 2, "out: holds files that are no results"},
    {"ChangesOverItsOwnResults", both(write("out/000000.png", ""), write("out/changes.json", kOurs)), kChanges, 0, "",
     "out/000002.ply"},
    {"RecognizeOverAForeignReport", write("out/report.html", "mine"), kRecognize, 2,
     "out: holds files that are no results of 'resight recognize'"},
    {"RecognizeOverAForeignSummary", write("out/summary.json", "{\"mine\": 1}"), kRecognize, 2,
     "out: holds files that are no results"},
    {"RecognizeAfterAKilledOne", write("out/finished_views.jsonl", "{\"view\":0,\"na"), kRecognize, 0, "",
     "out/report.html"},
    {"EvaluateOverForeignTables", write("out/tables.md", "mine"), kEvaluate, 2, "out: holds files that are no results"},
    {"EvaluateBesideForeignRuns", write("out/runs/mine.json", "{}"), kEvaluate, 2,
     "out: holds files that are no results"},
    {"EvaluateBesideForeignTablesAndNoRun",
     both(write("out/runs/.views.json.resight-partial", ""), write("out/tables.md", "mine")), kEvaluate, 2,
     "out: holds files that are no results"},
    {"EvaluateAfterAKilledOne", write("out/runs/.views.json.resight-partial", ""), kEvaluate, 0, "", "out/tables.md"},
    {"CheckOverForeignFindings", write("out/findings.json", "{}"), "check views --out out", 2,
     "out: holds files that are no results"},
    {"AnnotateOverForeignProposals", write("out/proposals.json", "{}"),
     "annotate --models models.resight --sequence views --out out --no-open", 2,
     "out: holds files that are no results"},
    {"ChangesInANewFolderOfTheSequence", kNothing, "changes --sequence views --out views/changes", 0, "",
     "views/changes/changes.json"},
    {"AnnotateAProjectInTheSequence", write("views/annotation/annotation.jsonl", "of others\n"),
     "annotate --models models.resight --sequence views --out views/annotation --no-open", 2,
     "views/annotation: holds files that are no results"},
    {"RecognizeToNowhere", kNothing, "recognize --models models.resight --sequence views --out ''", 2,
     "--out: '' \\(a value was expected"},
    {"ChangesToALinkToNowhere", link("dangling", "nowhere"), "changes --sequence views --out dangling", 2,
     "dangling is a link that leads nowhere"},
    {"EvaluateToALinkToNowhere", link("dangling", "nowhere"),
     "evaluate --models models.resight --dataset views -k 0 --out dangling", 2,
     "dangling is a link that leads nowhere"},
    {"EvaluateOntoAFile", kNothing, "evaluate --models models.resight --dataset views -k 0 --out file", 2,
     "file: exists already and is not a folder"},
    {"EvaluateWithAFileForItsRuns", write("out/runs", ""),
     "evaluate --models models.resight --dataset views -k 0 --out out", 2, "out: holds files that are no results"},
    {"EvaluateWithoutMeshes", kNothing, "evaluate --models models.resight --dataset views -k 0 --bop --out out", 2,
     "models: "},
    {"SimulateToALinkToNowhere", link("dangling", "nowhere"), "simulate --preset demo --out dangling", 2,
     "dangling is a link that leads nowhere"},
    {"ModelToALinkToNowhere", link("dangling", "nowhere"), "model --sequence tuw --out dangling", 2,
     "dangling is a link that leads nowhere"},
    {"CheckOntoAFile", kNothing, "check views --out file", 2, "file: exists already and is not a folder"},
    {"RecognizeWithAFolderForAResult", write("out/summary.json/mine", ""), kRecognize, 2,
     "out/summary\\.json: is a folder"},
    {"RecognizeWithAFolderForItsReport", write("out/report.html/mine", ""), kRecognize, 2,
     "out/report\\.html: is a folder"},
    {"EvaluateWithAFolderForARun", write("out/runs/views.json/mine", ""),
     "evaluate --models models.resight --dataset views -k 0 --out out", 2, "out/runs/views\\.json: is a folder"},
    {"ChangesWithAFolderForACloud", write("out/00002.ply/mine", ""), "changes --sequence views --out out", 2,
     "out/00002\\.ply: is a folder"},
    {"ChangesWithAFolderForAMask", write("out/novel/00002.png/mine", ""), "changes --sequence views --out out", 2,
     "out/novel/00002\\.png: is a folder"},
    {"TrainBesideAForeignTemporaryName", link(".new.resight.resight-partial", "nowhere"),
     "train meshes --out new.resight", 2, "new\\.resight: cannot be written .*is in the way"},
    {"RecognizeWithAFileForItsPages", write("out/report_pages", ""), kRecognize, 2,
     "out: holds files that are no results"},
    {"ChangesOverResultsOfRecognize", both(write("out/summary.json", kOurs), write("out/changes.json", kOurs)),
     kChanges, 2, "out: holds results of 'resight recognize'"},
    {"RecognizeOverResultsOfChanges", write("out/changes.json", kOurs), kRecognize, 2,
     "out: holds results of 'resight changes'"},
    {"RecognizeIntoASequence", kNothing, "recognize --models models.resight --sequence views --out tum", 2,
     "tum: holds files that are no results"},
    {"ViewResultsOfChanges", write("out/changes.json", "{}"), "view out --no-open", 2,
     "out: holds results of 'resight changes'"},
    {"RecognizeIntoAMixtureOfUnknownOrigin", write("out/.resight-unfinished", "x"), kRecognize, 2,
     "out: holds a mixture of old and new files"},
    {"RecognizeAnUnfinishedSequence", write("views/.resight-unfinished", ""), kRecognize, 2, "views: is not finished"},
    {"EvaluateBelowAnUnfinishedSet", both(move("views", "set/test/views"), write("set/.resight-unfinished", "")),
     "evaluate --models models.resight --dataset set/test -k 0 --out out", 2, "set: is not finished"},
    {"RecognizeAnUnfinishedSequenceBelow", both(move("views", "set/views"), write("set/views/.resight-unfinished", "")),
     "recognize --models models.resight --sequence set --out out", 2, "set/views: is not finished"},
    {"ConvertAnUnfinishedSequenceBelow", both(move("views", "set/views"), write("set/views/.resight-unfinished", "")),
     "convert set out --to tuw", 2, "set/views: is not finished"},
    {"EvaluateBesideAnUnfinishedSequence", both(copy("views", "set/a"), write("set/b/.resight-unfinished", "")),
     "evaluate --models models.resight --dataset set --presets mvr -k 0 --out out", 2, "set/b: is not finished"},
    {"TrainFromUnfinishedModelsBelow",
     both(move("meshes/cube.ply", "set/models/obj_000001.ply"), write("set/models/.resight-unfinished", "")),
     "train set --out new.resight", 2, "set/models: is not finished"},
    {"TrainBesideAnUnfinishedModel", write("meshes/half/.resight-unfinished", ""), kTrain, 2,
     "meshes/half: is not finished"},
    {"ViewUnfinishedChanges", both(write("res/000000.ply", ""), write("res/.resight-unfinished", "")),
     "view views --changes res --no-open", 2, "res: is not finished"},
    {"TrainFromUnfinishedModels", write("meshes/.resight-unfinished", ""), kTrain, 2, "meshes: is not finished"},
    {"ViewUnfinishedResults", write("res/.resight-unfinished", ""), "view res --no-open", 2, "res: is not finished"},
    {"ConvertIntoAnEmptyFolder", kNothing, "convert views empty --to tuw", 0, "", "empty/000001.pcd"},
    {"ConvertModelsAfterAnInterruption", write(".out.resight-partial/models/a", "cut o"), "convert meshes out --to bop",
     0, "", "out/models/models_info.json"},
    {"ConvertBelowAFile", kNothing, "convert views file/out --to tuw", 2, "file is not a folder"},
    {"ConvertOverData", kNothing, "convert views full --to tuw", 2, "full: exists already"},
    {"SimulateBelowAFile", kNothing, "simulate --preset demo --out file/out", 2, "file/out: "},
    {"SimulateOverData", kNothing, "simulate --preset demo --out full", 2, "full: exists already"},
    {"DemoBelowAFile", kNothing, "demo --out file/out", 2, "file"},
    {"DemoOverData", kNothing, "demo --out full", 2, "full: "},
    {"DemoOntoAFile", kNothing, "demo --out file", 2, "file"},
};

INSTANTIATE_TEST_SUITE_P(Outputs, CommandLine, testing::ValuesIn(kOutputRows), name_of_row);

TEST_F(CommandLineResults, ModelTakesSomeOfManyViews) {
  fs::create_directories(folder_ / "many");
  for (int view = 100; view < 401; ++view) {
    const std::string number = std::to_string(view);
    fs::create_hard_link(folder_ / "views/rgb/000000.png", folder_ / "many" / ("color_" + number + ".png"));
    fs::create_hard_link(folder_ / "views/depth/000000.png", folder_ / "many" / ("depth_" + number + ".png"));
  }
  const Outcome outcome = run(folder_, "model --sequence many --intrinsics 60,60,31.5,23.5 --out out");
  EXPECT_EQ(outcome.status, 1);
  EXPECT_THAT(outcome.output, testing::HasSubstr("many: 301 views, takes one of 3\n"));
}

}  // namespace
}  // namespace resight::cli_test
