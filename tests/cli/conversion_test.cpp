// SPDX-License-Identifier: Apache-2.0
// Conversion, the viewer, and generated scenes.
#include "cli.hpp"

namespace resight::cli_test {
namespace {

constexpr const char* kEventOfView9 = R"({"events": [{"view": 9, "kind": "added", "object": "cube", "known": true}]})";
constexpr const char* kEventOfHostileName =
    R"({"events": [{"view": 1, "kind": "added", "object": "../../x", "known": true}]})";

const Row kConversionRows[] = {
    // Conversion and scenes.
    {"ConvertMissing", kNothing, "convert nowhere out --to bop", 2, "nowhere: no such file or folder"},
    {"ConvertNothing", kNothing, "convert empty out --to bop", 2, "empty: "},
    {"ConvertABrokenView", cut("views/depth/000002.png", 0.5), kConvert, 2, "000002\\.png: "},
    {"ConvertChangesOfOtherViews", write("tuw.changes", "cloud_07_cube_0.txt\n"), "convert tuw out --to bop", 2,
     "tuw\\.changes: cloud_07_cube_0\\.txt: the sequence has no such view"},
    {"ConvertChanges", write("tuw/any.changes", "cloud_00_cube_0"), "convert tuw out --to tuw", 0, "",
     "out/out.changes"},
    {"ConvertChangesWithoutGroundTruth", both(remove_texts("tuw"), write("tuw/any.changes", "cloud_00_cube_0.txt\n")),
     "convert tuw out --to bop", 0, "", "out"},
    {"ConvertChangesWithoutNames", write("tuw/any.changes", "nan\n"), "convert tuw out --to tuw", 2,
     "any\\.changes: line 1: expected names like"},
    {"ConvertChangesWithoutAnnotation", write("tuw.changes", "cloud_00_cube_3.txt\n"), "convert tuw out --to bop", 2,
     "tuw\\.changes: view 0 has no annotation of 'cube' with instance 3"},
    {"ConvertBrokenEvents", write("tuw.events.json", "{"), "convert tuw out --to bop", 2,
     "tuw\\.events\\.json: is not"},
    {"ConvertSomeViewsOfASequenceWithEvents", write("views/events.json", R"({"events": [[1, "added", "cube"]]})"),
     "convert views out --to bop --every 2", 0, "the true changes are left out, because not all views are converted",
     "out"},
    {"ConvertEventsOfASetWithManyViews", both(move("tuw", "set/test/tuw"), write("set/events.json", kEventOfView9)),
     "convert set/test/tuw out --to bop", 2, "set/events\\.json: events\\[0\\]: view: 9, but the sequence has 3 views"},
    {"EvaluateEventsOfASetWithAHostileName",
     both(move("views", "set/test/views"), write("set/events.json", kEventOfHostileName)),
     "evaluate --models models.resight --dataset set --presets mvr -k 0 --out out", 2,
     "set/events\\.json: events\\[0\\]: object: the name of an object '\\.\\./\\.\\./x' has"},
    {"EvaluateAPipeAsEventsOfASet", both(move("views", "set/test/views"), pipe("set/events.json")),
     "evaluate --models models.resight --dataset set --presets mvr -k 0 --out out", 2,
     "set/events\\.json: is not a file"},
    {"EvaluateEventsThatLeadNowhere", link("views/events.json", "nowhere"), kEvaluate, 2,
     "views/events\\.json: no such file"},
    {"ConvertEventsThatLeadNowhere", link("tuw.events.json", "nowhere"), "convert tuw out --to bop", 2,
     "tuw\\.events\\.json: no such file"},
    {"EvaluateChangesThatLeadNowhere", link("tuw/any.changes", "nowhere"),
     "evaluate --models models.resight --dataset tuw -k 0 --out out", 2, "tuw/any\\.changes: no such file"},
    {"EvaluateBesideAFolderOfChanges", write("tuw.changes/mine.txt", "mine"),
     "evaluate --models models.resight --dataset tuw --presets mvr -k 0 --out out", 0, "", "out/results.json"},
    {"EvaluateChangesWithoutAnnotation", write("tuw.changes", "cloud_00_cube_3.txt\n"),
     "evaluate --models models.resight --dataset tuw -k 0 --out out", 2,
     "tuw\\.changes: view 0 has no annotation of 'cube' with instance 3"},
    {"ConvertABrokenMesh", cut("meshes/cube.ply", 0.9), "convert meshes out --to bop", 2, "cube\\.ply: "},
    {"ConvertACloudToViews", write("thing/3D_model.pcd", kUnorganizedPcd), "convert thing out --to tuw", 2,
     "3D_model\\.pcd: is a cloud without views"},
    {"ConvertAModelThatNoViewShows",
     both(copy("tuw/cloud_01.pcd", "meshes/z/views/cloud_01.pcd"),
          both(write("meshes/z/views/pose_01.txt", "1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n"),
               write("meshes/z/views/object_indices_01.txt", ""))),
     "convert meshes out --to bop", 2, "meshes/z: .*the masks of all training views are empty"},
    {"ConvertABrokenMeshToViews", cut("meshes/cube.ply", 0.9), "convert meshes out --to tuw", 2, "cube\\.ply: "},
    {"ViewNothing", kNothing, "view", 2, "view: inputs is required"},
    {"ViewMissing", kNothing, "view nowhere --no-open", 2, "nowhere: no such file or directory"},
    {"ViewEmpty", kNothing, "view empty --no-open", 2, "empty: is nothing to view \\(expected results"},
    {"ViewWithoutIntrinsics", remove("tum/camera.txt"), "view tum --no-open", 2,
     "tum: holds no camera\\.txt.*--intrinsics fx,fy,cx,cy"},
    {"ViewWithIntrinsics", remove("tum/camera.txt"), "view tum --intrinsics 60,60,31.5,23.5 --changes meshes --no-open",
     2, "meshes: "},
    {"ViewOnAWrongPort", kNothing, "view views --no-open --port 65536", 2, "port"},
    {"ViewWithoutLibrary", kNothing, "view views --no-open --models views", 2, "views: is not a file"},
    {"ViewBrokenLibrary", cut("models.resight", 0.5), "view models.resight --no-open", 2, "models\\.resight: "},
    {"ViewBrokenResults", write("res/detections.json", "{"), "view res --no-open", 2,
     "res/detections\\.json: is not valid JSON"},
    {"ViewResultsOfUnknownViews",
     both(write("res/detections.json", R"({"version": "1", "preset": "mvr", "views": []})"),
          write("res/changes.json", R"({"events": [], "views": []})")),
     "view res --no-open", 2, "res: the results do not name their sequence \\(pass --sequence\\)"},
    {"ViewOtherChanges", kNothing, "view views --changes meshes --no-open", 2,
     "meshes: holds no results of 'resight changes' on these views"},
    {"ViewChangesOfModels", kNothing, "view models.resight --changes meshes --no-open", 2,
     "meshes: needs the sequence"},
    {"ViewSequencesBesideEachOther", kNothing, "view views tuw --no-open", 2, "views: holds no results"},
    {"MissingScript", kNothing, "simulate no.toml --out out", 2, "no\\.toml: "},
    {"ScriptThatIsNoToml", write("s.toml", "[[object\n"), "simulate s.toml --out out", 2, "s\\.toml: "},
    {"EndlessScript", kNothing, "simulate /dev/zero --out out", 2, "/dev/zero: is not a file"},
    {"PipeAsScript", pipe("s.toml"), "simulate s.toml --out out", 2, "s\\.toml: is not a file"},
    {"EmptyScript", write("s.toml", ""), "simulate s.toml --out out", 2, "s\\.toml: "},
};

INSTANTIATE_TEST_SUITE_P(Conversion, CommandLine, testing::ValuesIn(kConversionRows), name_of_row);

}  // namespace
}  // namespace resight::cli_test
