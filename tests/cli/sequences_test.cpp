// SPDX-License-Identifier: Apache-2.0
// Sequences, and what the user says about them.
#include "cli.hpp"

namespace resight::cli_test {
namespace {

const std::string kLongName(300, 'a');
const std::string kTrackLongName = "track --sequence " + kLongName + " --out poses.txt";
constexpr const char* kOtherNames = R"({"1": {"diameter": 140, "name": "die"}})";
constexpr const char* kUnorganizedPcd =
    "VERSION .7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 4\nHEIGHT 1\nPOINTS 4\nDATA ascii\n"
    "0 0 0\n.1 0 0\n0 .1 0\n0 0 .1\n";

const Row kRows[] = {
    // What the user says about a sequence.
    {"TumWithoutCamera", remove("tum/camera.txt"), "changes --sequence tum --out out", 2,
     "tum: holds no camera\\.txt.*--intrinsics fx,fy,cx,cy"},
    {"TumWithIntrinsics", remove("tum/camera.txt"),
     "changes --sequence tum --intrinsics 60,60,31.5,23.5 --every 2 --out out", 0, "", "out/changes.json"},
    {"IntrinsicsOfAnotherForm", kNothing, "changes --sequence tum --intrinsics 60,60 --out out", 2,
     "--intrinsics: 2 numbers; expected fx fy cx cy"},
    {"IntrinsicsThatAreNotThere", kNothing, "changes --sequence tum --intrinsics nowhere --out out", 2,
     "nowhere: no such file"},
    {"DepthScaleUpsideDown", kNothing, "changes --sequence tum --depth-scale 5000 --out out", 2,
     "5000 is not a number of metres per unit"},
    {"PosesThatAreNotThere", kNothing, "recognize --models models.resight --sequence views --poses nowhere --out out",
     2, "nowhere"},
    {"PosesOfNoView", write("poses.txt", "999 0 0 0 0 0 0 1\n"), "changes --sequence tum --poses poses.txt --out out",
     2, "poses\\.txt: holds no pose of any view"},
    {"OptionsForPcdViews", kNothing, "changes --sequence tuw --depth-scale 0.001 --out out", 2,
     "--depth-scale.*do not apply"},
    {"RecordingThatIsCutOff", write("a.bag", "#ROSBAG V2.0\n12"), "changes --sequence a.bag --out out", 2,
     "a\\.bag: ends at byte 15"},
    {"TextAsRecording", kNothing, "changes --sequence file --out out", 2, "file: is neither a folder nor a recording"},
    {"InfoOfASequence", kNothing, "info views", 0, ""},
    {"InfoOfALibrary", kNothing, "info models.resight --json", 0, ""},
    {"InfoOfModels", kNothing, "info meshes", 0, ""},
    {"InfoOfNothing", kNothing, "info empty", 2, "empty: no sequence found"},
    {"InfoOfATruncatedLibrary", cut("models.resight", 0.7), "info models.resight", 2, "models\\.resight: truncated"},

    // Sequences.
    {"MissingSequence", remove("views"), kRecognize, 2, "views: no such directory"},
    {"SequenceThatIsALoop", link("loop", "loop"), "changes --sequence loop --out out", 2, "loop: "},
    {"SequenceWithALongName", kNothing, kTrackLongName.c_str(), 2, "aaa: "},
    {"OutputThatIsALoop", link("loop", "loop"), "changes --sequence views --out loop", 2, "loop: "},
    {"EvaluateBesideALoop", both(move("views", "set/views"), link("set/loop", "loop")),
     "evaluate --models models.resight --dataset set --presets mvr -k 0 --out out", 0, "", "out/results.json"},
    {"EvaluateBesideADamagedSequence",
     both(both(move("views", "set/views"), move("tuw", "set/tuw")), cut("set/views/scene_gt.json", 0.6)),
     "evaluate --models models.resight --dataset set --presets mvr -k 0 --out out", 2, "scene_gt\\.json: "},
    {"ConvertADamagedSequenceBesideModels",
     both(both(move("views", "set/views"), move("meshes", "set/models")), cut("set/views/scene_gt.json", 0.6)),
     "convert set out --to tuw", 2, "scene_gt\\.json: "},
    {"TruthWithOtherNames", both(move("views", "set/test/views"), write("set/models/models_info.json", kOtherNames)),
     "evaluate --models models.resight --dataset set --presets mvr -k 0 --out out", 0,
     "views: the library has other names .* found by obj_id", "out/results.json"},
    {"EvaluateBesideAModel", both(move("views", "set/views"), write("set/thing/3D_model.pcd", kUnorganizedPcd)),
     "evaluate --models models.resight --dataset set --presets mvr -k 0 --out out", 0, "", "out/results.json"},
    {"ConvertOneModel", write("thing/3D_model.pcd", kUnorganizedPcd), "convert thing out --to bop", 0, "",
     "out/models/models_info.json"},
    {"TruthOfOtherObjects", library([] {
       ModelLibrary library = make_library(40);
       library.objects[0].name = "die";
       library.objects[0].bop_id = 9;
       return library;
     }),
     "evaluate --models models.resight --dataset views --presets mvr -k 0 --out out", 0,
     "views: no true object is in the library", "out/results.json"},
    {"EmptyFolder", kNothing, "changes --sequence empty --out out", 2, "empty: no sequence found"},
    {"FileAsSequence", kNothing, "changes --sequence file --out out", 2, "file: "},
    {"SequenceWithoutViews", write("views/scene_camera.json", "{}"), kRecognize, 2, "scene_camera\\.json: "},
    {"TruncatedCameras", cut("views/scene_camera.json", 0.6), kRecognize, 2, "scene_camera\\.json: "},
    {"CamerasThatAreAList", write("views/scene_camera.json", "[1, 2]"), kRecognize, 2, "scene_camera\\.json: "},
    {"ZeroFocalLength", edit("views/scene_camera.json", [](Json& v) { v["cam_K"][0] = 0; }), kRecognize, 2,
     "image 1: cam_K"},
    {"NegativeFocalLength", edit("views/scene_camera.json", [](Json& v) { v["cam_K"][4] = -60; }), kRecognize, 2,
     "image 1: cam_K"},
    {"ShortIntrinsics",
     edit("views/scene_camera.json",
          [](Json& v) {
            v["cam_K"] = {60, 60};
          }),
     kRecognize, 2, "image 1: cam_K"},
    {"NullInIntrinsics", edit("views/scene_camera.json", [](Json& v) { v["cam_K"][0] = nullptr; }), kRecognize, 2,
     "image 1: cam_K"},
    {"ScaledPose", edit("views/scene_camera.json", [](Json& v) { v["cam_R_w2c"] = {2, 0, 0, 0, 2, 0, 0, 0, 2}; }),
     kRecognize, 2, "image 1: cam_R_w2c.*rigid"},
    {"MirroredPose", edit("views/scene_camera.json", [](Json& v) { v["cam_R_w2c"] = {-1, 0, 0, 0, 1, 0, 0, 0, 1}; }),
     kRecognize, 2, "image 1: cam_R_w2c.*"},
    {"PoseOfOneView", edit("views/scene_camera.json", [](Json& v) { v.erase("cam_R_w2c"); }), kRecognize, 2,
     "cam_R_w2c"},
    {"ZeroDepthScale", edit("views/scene_camera.json", [](Json& v) { v["depth_scale"] = 0; }), kRecognize, 2,
     "image 1: depth_scale"},
    {"TruncatedTruth", cut("views/scene_gt.json", 0.5), kRecognize, 2, "scene_gt\\.json: "},
    {"TruthWithABrokenPose",
     edit("views/scene_gt.json", [](Json& v) { v[0]["cam_R_m2c"] = {3, 0, 0, 0, 3, 0, 0, 0, 3}; }), kRecognize, 2,
     "scene_gt\\.json: image 1: cam_R_m2c"},
    {"MissingDepth", remove("views/depth/000001.png"), kRecognize, 2, "image 1: its depth image is missing"},
    {"EmptyDepth", write("views/depth/000001.png", ""), kRecognize, 2, "000001\\.png: ", "out/finished_views.jsonl"},
    {"TruncatedDepth", cut("views/depth/000001.png", 0.5), kRecognize, 2, "000001\\.png: ", "out/finished_views.jsonl"},
    {"TruncatedColor", cut("views/rgb/000001.png", 0.5), kRecognize, 2, "000001\\.png: ", "out/finished_views.jsonl"},
    {"ColorWithAFlippedBit", flip("views/rgb/000001.png", 0.5), kRecognize, 2,
     "000001\\.png: ", "out/finished_views.jsonl"},
    {"DepthWithAFlippedBit", flip("views/depth/000001.png", 0.5), kChanges, 2, "000001\\.png: "},
    {"TextAsColor", write("views/rgb/000001.png", "hello"), kChanges, 2, "000001\\.png: "},
    {"ColorAsDepth", small_image("views/depth/000001.png"), kChanges, 2, "000001\\.png: "},
    {"SmallerColor", small_image("views/rgb/000001.png"), kRecognize, 2,
     "000001\\.png: is 64x48, but its colour image 32x48", "out/finished_views.jsonl"},
    {"SmallerColorInChanges", small_image("views/rgb/000001.png"), kChanges, 2,
     "000001\\.png: is 64x48, but its colour image 32x48"},
    {"SmallerColorInConvert", small_image("views/rgb/000001.png"), kConvert, 2,
     "000001\\.png: is 64x48, but its colour image 32x48"},
    {"SmallerColorOfTheLastView", small_image("views/rgb/000002.png"), kRecognize, 2,
     "000002\\.png: is 64x48, but its colour image 32x48", "out/finished_views.jsonl"},
    {"EvaluateAMissingFolder", kNothing, "evaluate --models models.resight --dataset nowhere --out out", 2,
     "nowhere: is not a folder"},
    {"EvaluateAnEmptyFolder", kNothing, "evaluate --models models.resight --dataset empty --out out", 2,
     "empty: no sequence found"},
    {"EvaluateWithoutTruth", remove("views/scene_gt.json"),
     "evaluate --models models.resight --dataset views -k 0 --out out", 2, "views: has no ground truth"},
    {"EvaluateABrokenView", cut("views/depth/000001.png", 0.5),
     "evaluate --models models.resight --dataset views -k 0 --out out", 2, "000001\\.png: "},
    {"NoDepthAtAll", no_depth_at_all(), kRecognize, 0,
     "warning: only 0\\.0 % of the pixels have depth; remedy: ", "out/changes.json"},
    {"CheckNothing", kNothing, "check empty", 2, "empty: "},
    {"CheckGoodViews", kNothing, "check views --json", 0, ""},
    {"CheckASinglePcdWithOptions", kNothing, "check tuw/cloud_01.pcd --depth-scale 0.001", 2,
     "cloud_01\\.pcd: consists of PCD files"},
    {"CheckWithoutDepth", no_depth_at_all(), "check views", 1, ""},
    {"CheckWithPictures", no_depth_at_all(), "check views --out out", 1, "", "out/no_depth.png"},
    {"StreamBesideTheViewer", kNothing, "recognize --models models.resight --sequence views --out out --stream --view",
     2, "--view excludes --stream"},
    {"NoDepthAtAllInChanges", no_depth_at_all(), kChanges, 0, "", "out/000002.ply"},
    {"TruncatedPcd", cut("tuw/cloud_01.pcd", 0.5), kChangesTuw, 2, "cloud_01\\.pcd: "},
    {"PcdOfAFewBytes", cut("tuw/cloud_01.pcd", 0.001), kChangesTuw, 2, "cloud_01\\.pcd: "},
    {"PcdThatLiesOnItsSize", replace("tuw/cloud_01.pcd", "WIDTH 64", "WIDTH 65"), kChangesTuw, 2, "cloud_01\\.pcd: "},
    {"PcdWithANanPose", replace("tuw/cloud_01.pcd", "VIEWPOINT 0", "VIEWPOINT nan"), kRecognizeTuw, 2,
     "cloud_01\\.pcd: .*VIEWPOINT"},
    {"PcdWithAZeroQuaternion", replace("tuw/cloud_01.pcd", "VIEWPOINT 0 0 0 1", "VIEWPOINT 0 0 0 0"), kRecognizeTuw, 2,
     "cloud_01\\.pcd: .*VIEWPOINT"},
    // The comment is unusable; the camera is fitted to the points instead.
    {"PcdWithZeroIntrinsics", replace("tuw/cloud_01.pcd", "# camera 60", "# camera 0"), kRecognizeTuw, 0, "",
     "out/detections.csv"},
    {"TumWithANanPose", replace("tum/groundtruth.txt", "2.0 0 0", "2.0 0 nan"), kChangesTum, 2, "groundtruth\\.txt: "},
    {"TumWithAZeroQuaternion", replace("tum/groundtruth.txt", "2.0 0 0 0 0 0 0 1", "2.0 0 0 0 0 0 0 0"), kChangesTum, 2,
     "groundtruth\\.txt: "},
    {"TumWithZeroIntrinsics", write("tum/camera.txt", "0 60 31.5 23.5\n"), kChangesTum, 2, "camera\\.txt: "},
    {"TumWithoutImages", remove("tum/rgb"), kChangesTum, 2, "tum"},
    {"TumWithAMissingImage", remove("tum/depth/2.0.png"), kChangesTum, 2, "2\\.0\\.png: "},
};

INSTANTIATE_TEST_SUITE_P(Sequences, CommandLine, testing::ValuesIn(kRows), name_of_row);

}  // namespace
}  // namespace resight::cli_test
