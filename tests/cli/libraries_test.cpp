// SPDX-License-Identifier: Apache-2.0
// Model libraries, and what they are trained from.
#include <limits>

#include "cli.hpp"

namespace resight::cli_test {
namespace {

const std::string kRecognizeVeryLongName =
    "recognize --models " + std::string(50000, 'a') + " --sequence views --out out";
constexpr const char* kGltfWithBuffer = R"({"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}],
    "nodes": [{"mesh": 0}], "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
    "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"}],
    "bufferViews": [{"buffer": 0, "byteLength": 36}], "buffers": [{"uri": "z.bin", "byteLength": 36}]})";
const std::string kRecognizeLongName = "recognize --models " + kLongName + " --sequence views --out out";

TriangleMesh make_cube_with(float x) {
  TriangleMesh cube = make_cube(1);
  cube.vertices[5].x() = x;
  return cube;
}

/// A cube of which only edges are left.
TriangleMesh make_lines() {
  TriangleMesh cube = make_cube(1);
  for (auto& face : cube.faces) face[2] = face[1];
  return cube;
}

TriangleMesh make_uncolored_cube() {
  TriangleMesh cube = make_cube(1);
  cube.colors.clear();
  return cube;
}

ModelLibrary make_stale_library() {
  ModelLibrary stale = make_library(40);
  ++stale.options_hash;
  return stale;
}

ModelLibrary make_empty_library() {
  ModelLibrary empty = make_library(0);
  empty.objects.clear();
  return empty;
}

const Row kLibraryRows[] = {
    // Model libraries.
    {"MissingLibrary", remove("models.resight"), kRecognize, 2, "models\\.resight: no such file"},
    {"FolderAsLibrary", kNothing, "recognize --models empty --sequence views --out out", 2, "empty: is not a file"},
    {"LibraryThatIsALoop", link("loop", "loop"), "recognize --models loop --sequence views --out out", 2,
     "loop: cannot be opened"},
    {"LibraryWithALongName", kNothing, kRecognizeLongName.c_str(), 2, "aaa: cannot be opened"},
    {"MessageOfAVeryLongName", kNothing, kRecognizeVeryLongName.c_str(), 2, "model library a{1986} \\.\\.\\.$"},
    {"EndlessLibrary", kNothing, "recognize --models /dev/zero --sequence views --out out", 2,
     "/dev/zero: is not a file"},
    {"EvaluateAPipeAsLibrary", pipe("models.resight"),
     "evaluate --models models.resight --dataset views -k 0 --out out", 2, "models\\.resight: is not a file"},
    {"BufferThatIsAPipe", both(write("meshes/z.gltf", kGltfWithBuffer), pipe("meshes/z.bin")), kTrain, 2,
     "z\\.gltf: .*z\\.bin"},
    {"PipeAsLibrary", pipe("models.resight"), kRecognize, 2, "models\\.resight: is not a file"},
    {"EvaluateAFolderAsLibrary", kNothing, "evaluate --models empty --dataset views --out out", 2,
     "empty: is not a file"},
    {"EmptyLibraryFile", write("models.resight", ""), kRecognize, 2, "not a model library"},
    {"TextAsLibrary", write("models.resight", "hello\n"), kRecognize, 2, "not a model library"},
    {"TruncatedLibrary", cut("models.resight", 0.7), kRecognize, 2, "models\\.resight: truncated"},
    {"LibraryOfAFewBytes", cut("models.resight", 0.0001), kRecognize, 2, "models\\.resight: truncated"},
    {"LibraryWithAFlippedBit", flip("models.resight", 0.5), kRecognize, 2, "models\\.resight: damaged"},
    {"LibraryOfOtherOptions", library(make_stale_library), kRecognize, 2, "trained with other options"},
    {"LibraryWithoutModels", library(make_empty_library), kRecognize, 2, "models\\.resight: contains no models"},
    {"LibraryWithoutFeatures", library([] { return make_library(0); }), kRecognize, 0, "warning: .*cube.* no features",
     "out/detections.csv"},

    // Training input.
    {"MissingMeshes", kNothing, "train nowhere --out new.resight", 2, "nowhere: no such file"},
    {"NoMeshes", kNothing, "train empty --out new.resight", 2, "empty: no model found"},
    {"TextAsMesh", kNothing, "train file --out new.resight", 2, "file: is no model file"},
    {"EmptyMeshFile", write("meshes/cube.ply", ""), kTrain, 2, "cube\\.ply: "},
    {"TruncatedMesh", cut("meshes/cube.ply", 0.9), kTrain, 2, "cube\\.ply: "},
    {"LastMeshIsTruncated", both(mesh("meshes/z.ply", [] { return make_cube(1); }), cut("meshes/z.ply", 0.9)), kTrain,
     2, "z\\.ply: "},
    {"LastMeshHasNoSurface", mesh("meshes/z.ply", make_lines), kTrain, 2, "z\\.ply: has no surface"},
    {"MeshThatIsALinkToNowhere", link("meshes/z.ply", "nowhere"), kTrain, 2, "z\\.ply: no such file"},
    {"MeshThatIsAPipe", pipe("meshes/z.ply"), kTrain, 2, "z\\.ply: is not a file"},
    {"MeshInMillimetres", mesh("meshes/cube.ply", [] { return make_cube(1000); }), kTrain, 2,
     "cube\\.ply: .*looks like millimetres"},
    {"BopMeshInMetres", mesh("meshes/obj_000001.ply", [] { return make_cube(1); }), kTrain, 2,
     "obj_000001\\.ply: .*looks like metres"},
    {"MeshOfAnotherUnit", mesh("meshes/cube.ply", [] { return make_cube(1000); }),
     "train meshes --mesh-unit mm --out new.resight", 0, "", "new.resight"},
    {"MeshUnitOfViewsOnly", write("thing/views/cloud_00.pcd", kUnorganizedPcd),
     "train thing --mesh-unit mm --out new.resight", 2, "--mesh-unit has no effect: no model is a mesh or a cloud"},
    {"MeshWithoutColours", mesh("meshes/cube.ply", make_uncolored_cube), kTrain, 0,
     "note: 1 of 1 objects have no colours and are recognised by shape alone", "new.resight"},
    {"MeshOfAnUnknownUnit", kNothing, "train meshes --mesh-unit furlong --out new.resight", 2,
     "--mesh-unit: furlong not in .*mm"},
    {"MeshWithNan", mesh("meshes/cube.ply", [] { return make_cube_with(std::numeric_limits<float>::quiet_NaN()); }),
     kTrain, 2, "cube\\.ply: .*not finite"},
    {"MeshFarTooLarge", mesh("meshes/cube.ply", [] { return make_cube_with(1e30F); }), kTrain, 2, "cube\\.ply: "},
    {"MeshWithoutFaces", mesh("meshes/cube.ply", [] { return TriangleMesh{}; }), kTrain, 2, "cube\\.ply: "},
    {"ObjectWithoutName",
     both(write("models/obj_000001.ply", ""), write("models/models_info.json", R"({"1": {"name": ""}})")),
     "train models --out new.resight", 2, "models_info\\.json: object 1: the name of an object is empty"},
    {"MeshThatIsALoop", link("loop.obj", "loop.obj"), "train loop.obj --out new.resight", 2, "loop\\.obj"},
    {"TwoMeshesOfOneName", kNothing, "train meshes meshes --out new.resight", 2, "two models are called 'cube'"},
    {"SceneAsModels", kNothing, "train views --out new.resight", 2, "views: no model found"},
    {"MissingTexture",
     write(
         "meshes/cube.ply",
         "ply\nformat ascii 1.0\ncomment TextureFile no.png\nelement vertex 4\nproperty float x\nproperty float y\n"
         "property float z\nproperty float s\nproperty float t\nproperty uchar red\nproperty uchar green\nproperty "
         "uchar blue\nelement face 4\nproperty list uchar int vertex_indices\nend_header\n0 0 0 0 0 9 9 9\n.1 0 0 1 0 "
         "200 9 9\n0 .1 0 0 1 9 200 9\n0 0 .1 1 1 9 9 200\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n"),
     kTrain, 0, "warning: .*cube\\.ply: its texture is left out: .*no\\.png", "new.resight"},
};

INSTANTIATE_TEST_SUITE_P(Libraries, CommandLine, testing::ValuesIn(kLibraryRows), name_of_row);

}  // namespace
}  // namespace resight::cli_test
