// SPDX-License-Identifier: Apache-2.0
// Invalid input to the command line, one row per error. Each row runs the program in its own folder with valid data, of
// which the row damages something, and defines the exit status, the single line on standard error, and that no files
// are left.
#include <gmock/gmock.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmath>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <limits>
#include <nlohmann/json.hpp>
#include <numbers>
#include <regex>

#include "resight/core/files.hpp"
#include "resight/core/random.hpp"
#include "resight/io/images.hpp"
#include "resight/io/ply.hpp"
#include "resight/io/sequence.hpp"
#include "resight/models/library_file.hpp"
#include "resight/training/training.hpp"

namespace resight {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

constexpr int kWidth = 64;
constexpr int kHeight = 48;
constexpr int kViews = 3;

// ---- Small valid data: the content of each row's folder before it is damaged.

// A slanted wall in random colours.
RgbdFrame make_frame(int index) {
  Rng rng(static_cast<std::uint64_t>(index));
  RgbdFrame frame{.name = "cloud_0" + std::to_string(index),
                  .camera = {kWidth, kHeight, 60, 60, 31.5, 23.5},
                  .color = Image<Rgb8>(kWidth, kHeight),
                  .depth_m = Image<float>(kWidth, kHeight),
                  .world_from_camera = {}};
  for (std::size_t i = 0; i < frame.color.size(); ++i) {
    frame.color[i] = {static_cast<std::uint8_t>(rng.below(256)), static_cast<std::uint8_t>(rng.below(256)), 90};
    frame.depth_m[i] = 1.0F + 0.0001F * static_cast<float>(i % 1000);
  }
  return frame;
}

void write_sequence(const fs::path& folder, DatasetFormat format) {
  const auto writer = create_sequence(folder, format);
  ASSERT_TRUE(writer.ok()) << writer.error().message;
  for (int i = 0; i < kViews; ++i) ASSERT_TRUE((*writer)->write_view(make_frame(i), {{"cube", 1, 0, {}, 0.5}}).ok());
  ASSERT_TRUE((*writer)->finish().ok());
}

void write_text(const fs::path& file, const std::string& text) {
  fs::create_directories(file.parent_path());
  std::ofstream(file, std::ios::binary) << text;
}

std::string read_text(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

void write_tum(const fs::path& folder) {
  std::string list;
  std::string poses;
  for (int i = 0; i < kViews; ++i) {
    const std::string stamp = std::to_string(i + 1) + ".0";
    const RgbdFrame frame = make_frame(i);
    ASSERT_TRUE(write_color(folder / "rgb" / (stamp + ".png"), frame.color).ok());
    ASSERT_TRUE(write_depth(folder / "depth" / (stamp + ".png"), frame.depth_m, 1.0 / 5000).ok());
    list += stamp + " rgb/" + stamp + ".png " + stamp + " depth/" + stamp + ".png\n";
    poses += stamp + " 0 0 0 0 0 0 1\n";
  }
  write_text(folder / "associations.txt", list);
  write_text(folder / "groundtruth.txt", poses);
  write_text(folder / "camera.txt", "60 60 31.5 23.5\n");
}

// A cube of 8 cm around the origin. The sides share no vertices, so that edges are sharp.
TriangleMesh make_cube(float metre) {
  TriangleMesh mesh;
  for (int axis = 0; axis < 3; ++axis)
    for (const float side : {-0.04F, 0.04F}) {
      const int first = static_cast<int>(mesh.vertices.size());
      for (const auto& [u, v] : {std::pair(-1, -1), {1, -1}, {1, 1}, {-1, 1}}) {
        Eigen::Vector3f p;
        p[axis] = side;
        p[(axis + 1) % 3] = 0.04F * static_cast<float>(side > 0 ? u : v);
        p[(axis + 2) % 3] = 0.04F * static_cast<float>(side > 0 ? v : u);
        mesh.vertices.push_back(metre * p);
        mesh.colors.push_back({static_cast<std::uint8_t>(80 * axis + 60), 120, 70});
      }
      mesh.faces.push_back({first, first + 1, first + 2});
      mesh.faces.push_back({first, first + 2, first + 3});
    }
  return mesh;
}

CodedFeatures make_features(FeatureType type, int dimension, int count) {
  Rng rng(3);
  FeatureSet set{.type = type, .dimension = dimension, .points = {}, .normals = {}, .descriptors = {}};
  for (int i = 0; i < count; ++i) {
    set.points.push_back(
        {static_cast<float>(rng.uniform(-0.04, 0.04)), static_cast<float>(rng.uniform(-0.04, 0.04)), -0.04F});
    set.normals.push_back(-Eigen::Vector3f::UnitZ());
    Eigen::VectorXf descriptor(dimension);
    for (float& value : descriptor) value = static_cast<float>(rng.uniform());
    descriptor.normalize();
    set.descriptors.insert(set.descriptors.end(), descriptor.begin(), descriptor.end());
  }
  return encode(set);
}

ModelLibrary make_library(int num_features) {
  ObjectModel cube{.name = "cube",
                   .bop_id = 1,
                   .surface = {},
                   .sift = make_features(FeatureType::kSift, 128, num_features),
                   .shot = make_features(FeatureType::kShot, 352, num_features),
                   .symmetries = {},
                   .center = Eigen::Vector3f::Zero(),
                   .diameter_m = 0.14F};
  for (int i = 0; i < 20; ++i)
    for (int j = 0; j < 20; ++j) {
      cube.surface.points.push_back({0.004F * static_cast<float>(i - 10), 0.004F * static_cast<float>(j - 10), -0.04F});
      cube.surface.normals.push_back(-Eigen::Vector3f::UnitZ());
      cube.surface.colors.push_back({120, 120, 120});
    }
  ModelLibrary library;
  library.objects.push_back(std::move(cube));
  library.options_hash = TrainOptions{}.hash();
  return library;
}

void write_good_data(const fs::path& folder) {
  write_sequence(folder / "views", DatasetFormat::kBop);
  write_sequence(folder / "tuw", DatasetFormat::kTuw);
  write_tum(folder / "tum");
  ASSERT_TRUE(write_ply(folder / "meshes/cube.ply", make_cube(1)).ok());
  ASSERT_TRUE(save_library(make_library(40), folder / "models.resight").ok());
  fs::create_directories(folder / "empty");
  write_text(folder / "full/mine.txt", "mine");
  write_text(folder / "file", "a file\n");
}

// ---- Ways to damage it.

using Spoil = std::function<void(const fs::path& folder)>;

Spoil remove(const char* path) {
  return [=](const fs::path& folder) { ASSERT_GT(fs::remove_all(folder / path), 0U); };
}
Spoil write(const char* path, const char* text) {
  return [=](const fs::path& folder) { write_text(folder / path, text); };
}
Spoil cut(const char* path, double share) {
  return [=](const fs::path& folder) {
    const auto size = static_cast<double>(fs::file_size(folder / path));
    fs::resize_file(folder / path, static_cast<std::uintmax_t>(share * size));
  };
}
// A pipe without a writer: whoever opens it waits for ever.
Spoil pipe(const char* path) {
  return [=](const fs::path& folder) {
    fs::remove(folder / path);
    ASSERT_EQ(::mkfifo((folder / path).c_str(), 0600), 0);
  };
}
// Flips one bit of the byte at this share of the file.
Spoil flip(const char* path, double share) {
  return [=](const fs::path& folder) {
    std::string bytes = read_text(folder / path);
    ASSERT_FALSE(bytes.empty());
    char& byte = bytes[static_cast<std::size_t>(share * static_cast<double>(bytes.size()))];
    byte = static_cast<char>(byte ^ 0x10);
    write_text(folder / path, bytes);
  };
}
Spoil replace(const char* path, const char* what, const char* by) {
  return [=](const fs::path& folder) {
    std::string text = read_text(folder / path);
    const std::size_t at = text.find(what);
    ASSERT_NE(at, std::string::npos) << what;
    write_text(folder / path, text.replace(at, std::string(what).size(), by));
  };
}
// Edits the entry of the second view in a JSON file of the BOP scene.
Spoil edit(const char* path, const std::function<void(Json&)>& change) {
  return [=](const fs::path& folder) {
    Json json = Json::parse(read_text(folder / path));
    change(json.at("1"));
    write_text(folder / path, json.dump());
  };
}
Spoil link(const char* path, const char* target) {
  return [=](const fs::path& folder) {
    fs::create_directories((folder / path).parent_path());
    fs::create_symlink(target, folder / path);
  };
}
Spoil both(const Spoil& first, const Spoil& second) {
  return [=](const fs::path& folder) {
    first(folder);
    second(folder);
  };
}
Spoil move(const char* from, const char* to) {
  return [=](const fs::path& folder) {
    fs::create_directories((folder / to).parent_path());
    fs::rename(folder / from, folder / to);
  };
}
Spoil remove_texts(const char* path) {
  return [=](const fs::path& folder) {
    std::vector<fs::path> texts;
    for (const auto& entry : fs::directory_iterator(folder / path))
      if (entry.path().extension() == ".txt") texts.push_back(entry.path());
    ASSERT_FALSE(texts.empty());
    for (const fs::path& text : texts) fs::remove(text);
  };
}
Spoil small_image(const char* path) {
  return
      [=](const fs::path& folder) { ASSERT_TRUE(write_color(folder / path, Image<Rgb8>(kWidth / 2, kHeight)).ok()); };
}
Spoil no_depth_at_all() {
  return [](const fs::path& folder) {
    const Image<float> nothing(kWidth, kHeight, std::numeric_limits<float>::quiet_NaN());
    for (int i = 0; i < kViews; ++i)
      ASSERT_TRUE(write_depth(folder / "views/depth" / ("00000" + std::to_string(i) + ".png"), nothing, 1e-4).ok());
  };
}
Spoil library(const std::function<ModelLibrary()>& make) {
  return [=](const fs::path& folder) { ASSERT_TRUE(save_library(make(), folder / "models.resight").ok()); };
}
Spoil mesh(const char* path, const std::function<TriangleMesh()>& make) {
  return [=](const fs::path& folder) { ASSERT_TRUE(write_ply(folder / path, make()).ok()); };
}

// ---- The table.

struct Row {
  const char* name;
  Spoil spoil;
  const char* command;  // Run in the row's folder.
  int status;
  // Pattern of the one line on standard error; "" = no line.
  const char* line;
  // What exists afterwards; null: nothing new.
  const char* makes = nullptr;
};

constexpr const char* kRecognize = "recognize --models models.resight --sequence views --out out";
constexpr const char* kRecognizeTuw = "recognize --models models.resight --sequence tuw --out out";
constexpr const char* kChanges = "changes --sequence views --out out";
constexpr const char* kChangesTuw = "changes --sequence tuw --out out";
constexpr const char* kChangesTum = "changes --sequence tum --out out";
constexpr const char* kConvert = "convert views out --to tuw";
const std::string kLongName(300, 'a');
const std::string kRecognizeLongName = "recognize --models " + kLongName + " --sequence views --out out";
const std::string kTrackLongName = "track --sequence " + kLongName + " --out poses.txt";
const std::string kTrainToLongName = "train meshes --out " + kLongName;
constexpr const char* kOtherNames = R"({"1": {"diameter": 140, "name": "die"}})";
constexpr const char* kUnorganizedPcd =
    "VERSION .7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 4\nHEIGHT 1\nPOINTS 4\nDATA ascii\n"
    "0 0 0\n.1 0 0\n0 .1 0\n0 0 .1\n";
constexpr const char* kTrain = "train meshes --out new.resight";
const Spoil kNothing = [](const fs::path&) {};

TriangleMesh make_cube_with(float x) {
  TriangleMesh cube = make_cube(1);
  cube.vertices[5].x() = x;
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

const Row kRows[] = {
    // The valid data are accepted, so the other rows fail because of what they damage.
    {"Version", kNothing, "--version", 0, ""},
    {"Help", kNothing, "recognize --help", 0, ""},
    {"Recognize", kNothing, kRecognize, 0, "", "out/report.html"},
    {"RecognizeTuw", kNothing, kRecognizeTuw, 0, "", "out/detections.csv"},
    {"Changes", kNothing, kChanges, 0, "", "out/000002.ply"},
    {"ChangesTuw", kNothing, kChangesTuw, 0, "", "out/cloud_02.png"},
    {"ChangesTum", kNothing, kChangesTum, 0, "", "out"},
    {"Convert", kNothing, kConvert, 0, "", "out"},
    {"Evaluate", kNothing, "evaluate --models models.resight --dataset views --presets mvr -k 0 --out out", 0, "",
     "out/results.json"},
    {"Train", kNothing, kTrain, 0, "", "new.resight"},

    // The command line.
    {"NoCommand", kNothing, "", 2, "no command was given .*recognize"},
    {"UnknownCommand", kNothing, "nonsense", 2, "unknown command 'nonsense' .*recognize"},
    {"UnknownOptionBeforeTheCommand", kNothing, "--nonsense", 2, "unknown option '--nonsense'"},
    {"UnknownOption", kNothing, "changes --sequence views --out out --nonsense", 2, "changes: .*--nonsense"},
    {"MissingOption", kNothing, "changes --sequence views", 2, "changes: --out is required"},
    {"OptionWithoutValue", kNothing, "changes --sequence views --out", 2, "changes: --out"},
    {"UnknownPreset", kNothing, "changes --sequence views --out out --preset best", 2, "best .*mvr-chd"},
    {"NegativeK", kNothing, "changes --sequence views --out out -k -1", 2, "-1 .*0"},
    {"BrokenK", kNothing, "changes --sequence views --out out -k 1.5", 2, "1\\.5"},
    {"KThatIsAWord", kNothing, "changes --sequence views --out out -k all", 2, "all"},
    {"NoThreads", kNothing, "changes --sequence views --out out -j 0", 2, "0 .*1"},
    {"NegativeSeed", kNothing, "recognize --models models.resight --sequence views --out out --seed -1", 2, "seed"},
    {"NegativeDeadline", kNothing, "recognize --models models.resight --sequence views --out out --deadline-ms -1", 2,
     "deadline-ms: -1 is not a number above 0"},
    {"DeadlineThatIsNoNumber", kNothing,
     "recognize --models models.resight --sequence views --out out --deadline-ms nan", 2,
     "nan is not a number above 0"},
    {"NameWithEscapeSequences", kNothing,
     "changes --sequence \"$(printf 'no\\033[31mwhere\\nresight: done')\" --out out", 2,
     "no\\\\x1b\\[31mwhere\\\\x0aresight: done: no such"},
    {"ZeroDeadline", kNothing, "recognize --models models.resight --sequence views --out out --deadline-ms 0", 2,
     "deadline-ms"},
    {"SeedThatIsTooLarge", kNothing, "demo --out out --seed 99999999999999999999", 2, "seed"},
    {"UnknownFormat", kNothing, "convert views out --to png", 2, "png .*bop"},
    {"UnknownScene", kNothing, "simulate --preset nonsense --out out", 2, "nonsense"},
    {"TrackWithoutSequence", kNothing, "track --out poses.txt", 2, "--sequence"},
    {"TrackOfMissingSequence", kNothing, "track --sequence nowhere --out poses.txt", 2, "nowhere"},
    {"TrackByAnUnknownWay", kNothing, "track --sequence views --out poses.txt --poses guess", 2, "guess .*refine"},
    {"TrackOverData", kNothing, "track --sequence views --out poses.txt --write-sequence full", 2,
     "full: exists already"},
    {"TrackWithoutLibrary", kNothing, "track --sequence views --out poses.txt --models no.resight", 2, "no\\.resight"},
    {"TrackWithACloudThatIsAPicture", kNothing, "track --sequence views --out poses.txt --fused cloud.png", 2,
     "cloud\\.png: .*\\.ply"},
    {"TrackOfTinyViews", kNothing, "track --sequence views --out poses.txt", 1, "no two views could be joined"},
    {"RecognizePosesByAnUnknownWay", kNothing, "recognize --models models.resight --sequence views --out out --poses x",
     2, "x .*auto"},
    {"ModelWithoutSequence", kNothing, "model --out out", 2, "--sequence"},
    {"ModelOfMissingSequence", kNothing, "model --sequence nowhere --out out", 2, "nowhere"},
    {"ModelOverData", kNothing, "model --sequence tuw --out full", 2, "full: exists already"},
    {"ModelOntoNothing", kNothing, "model --sequence tuw --onto nowhere --out out", 2, "nowhere"},
    {"ModelOntoASequence", kNothing, "model --sequence tuw --onto tuw --out out", 2, "tuw"},
    {"ModelOfTinyViews", kNothing, "model --sequence tuw --out out", 1, "tuw: .*is 64 columns wide"},
    {"UnknownRecordedObject", kNothing, "simulate --preset turntable-recording --object nonsense --out out", 2,
     "nonsense"},
    {"ObjectOfAScene", kNothing, "simulate --preset demo --object mug --out out", 2, "--object"},
    {"NoScene", kNothing, "simulate --out out", 2, "neither"},
    {"TwoScenes", kNothing, "simulate scene.toml --preset demo --out out", 2, "simulate: .*excludes"},

    {"UnknownPresets", kNothing, "evaluate --models models.resight --dataset views --presets mvr,best --out out", 2,
     "--presets: .*best"},
    {"NoPresets", kNothing, "evaluate --models models.resight --dataset views --presets '' --out out", 2,
     "--presets: ''"},
    {"BrokenRangeOfK", kNothing, "evaluate --models models.resight --dataset views -k 3-1 --out out", 2,
     "--previous-views: '3-1'"},
    {"BrokenShard", kNothing, "evaluate --models models.resight --dataset views --shard 3/2 --out out", 2,
     "--shard: '3/2'"},

    // Settings files.
    {"MissingConfig", kNothing, "changes --sequence views --out out --config no.toml", 2, "no\\.toml: no such file"},
    {"FolderAsConfig", kNothing, "changes --sequence views --out out --config empty", 2, "empty: "},
    {"ConfigThatIsNoToml", write("c.toml", "[changes\n"), "changes --sequence views --out out --config c.toml", 2,
     "c\\.toml: line 1"},
    {"UnknownSetting", write("c.toml", "[changes]\nspeed = 1\n"), "changes --sequence views --out out --config c.toml",
     2, "c\\.toml: unknown key changes\\.speed"},
    {"SettingOutOfRange", write("c.toml", "[changes]\nvoxel_m = -0.01\n"),
     "changes --sequence views --out out --config c.toml", 2, "c\\.toml: .*voxel_m = -0\\.01"},

    {"PipeAsConfig", pipe("c.toml"), "changes --sequence views --out out --config c.toml", 2,
     "c\\.toml: is not a file"},
    {"EndlessConfig", kNothing, "changes --sequence views --out out --config /dev/zero", 2, "/dev/zero: is not a file"},

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
    {"TrainOverAForeignFile", kNothing, "train meshes --out file", 2, "file: exists already and is no model library"},
    {"TrainOverALink", link("dangling", "nowhere"), "train meshes --out dangling", 2,
     "dangling is a link that leads nowhere"},
    {"TrainOverALibrary", kNothing, "train meshes --out models.resight", 0, "", "models.resight"},
    {"TrainToALongName", kNothing, kTrainToLongName.c_str(), 2, "name is too long"},
    {"TrackOverTheSequence", kNothing, "track --sequence views --out views/scene_camera.json", 2,
     "scene_camera\\.json: exists already"},
    {"TrackBesideAForeignJournal", write("poses.txt.partial", "notes\n"), "track --sequence views --out poses.txt", 2,
     "poses\\.txt\\.partial: exists already"},
    {"TrackWithAPictureOverAnImage", kNothing, "track --sequence views --out poses.txt --fused views/rgb/000000.ply", 2,
     "000000\\.png: exists already"},
    {"TrackWithAForeignCloud", write("cloud.ply", "ply\nformat ascii 1.0\n"),
     "track --sequence views --out poses.txt --fused cloud.ply", 2, "cloud\\.ply: exists already"},
    {"TrackIntoTheNewSequence", kNothing, "track --sequence views --out new/poses.txt --write-sequence new", 2,
     "new/poses\\.txt: lies in the folder of --write-sequence"},
    {"TrackOverForeignObjects", write("poses_objects.txt", "mine\n"),
     "track --sequence views --out poses.txt --models models.resight", 2, "poses_objects\\.txt: exists already"},
    {"RecognizeIntoTheSequence", kNothing, "recognize --models models.resight --sequence views --out views", 2,
     "views: is an input"},
    {"ChangesOverTheImages", kNothing, "changes --sequence views --out views/rgb", 2,
     "views/rgb: is a folder of the input"},
    {"ChangesInANewFolderOfTheSequence", kNothing, "changes --sequence views --out views/changes", 0, "",
     "views/changes/changes.json"},
    {"RecognizeToNowhere", kNothing, "recognize --models models.resight --sequence views --out ''", 2,
     "the name of the output is empty"},
    {"ChangesToALinkToNowhere", link("dangling", "nowhere"), "changes --sequence views --out dangling", 2,
     "dangling is a link that leads nowhere"},
    {"EvaluateToALinkToNowhere", link("dangling", "nowhere"),
     "evaluate --models models.resight --dataset views -k 0 --out dangling", 2,
     "dangling is a link that leads nowhere"},
    {"EvaluateOntoAFile", kNothing, "evaluate --models models.resight --dataset views -k 0 --out file", 2,
     "file: exists already and is not a folder"},
    {"EvaluateWithAFileForItsRuns", write("out/runs", ""),
     "evaluate --models models.resight --dataset views -k 0 --out out", 2,
     "out/runs: exists already and is not a folder"},
    {"EvaluateWithoutMeshes", kNothing, "evaluate --models models.resight --dataset views -k 0 --bop --out out", 2,
     "models: "},
    {"SimulateToALinkToNowhere", link("dangling", "nowhere"), "simulate --preset demo --out dangling", 2,
     "dangling is a link that leads nowhere"},
    {"ModelToALinkToNowhere", link("dangling", "nowhere"), "model --sequence tuw --out dangling", 2,
     "dangling is a link that leads nowhere"},
    {"CheckOntoAFile", kNothing, "check views --out file", 2, "file: exists already and is not a folder"},
    {"RecognizeWithAFolderForAResult", write("out/summary.json/mine", ""), kRecognize, 2,
     "out/summary\\.json: is a folder"},
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

    // Model libraries.
    {"MissingLibrary", remove("models.resight"), kRecognize, 2, "models\\.resight: no such file"},
    {"FolderAsLibrary", kNothing, "recognize --models empty --sequence views --out out", 2, "empty: is not a file"},
    {"LibraryThatIsALoop", link("loop", "loop"), "recognize --models loop --sequence views --out out", 2,
     "loop: cannot be opened"},
    {"LibraryWithALongName", kNothing, kRecognizeLongName.c_str(), 2, "aaa: cannot be opened"},
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
    {"MeshInMillimetres", mesh("meshes/cube.ply", [] { return make_cube(1000); }), kTrain, 2,
     "cube\\.ply: .*looks like millimetres"},
    {"BopMeshInMetres", mesh("meshes/obj_000001.ply", [] { return make_cube(1); }), kTrain, 2,
     "obj_000001\\.ply: .*looks like metres"},
    {"MeshOfAnotherUnit", mesh("meshes/cube.ply", [] { return make_cube(1000); }),
     "train meshes --mesh-unit mm --out new.resight", 0, "", "new.resight"},
    {"MeshOfAnUnknownUnit", kNothing, "train meshes --mesh-unit furlong --out new.resight", 2, "--mesh-unit: "},
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
     write("meshes/cube.ply",
           "ply\nformat ascii 1.0\ncomment TextureFile no.png\nelement vertex 4\nproperty float x\nproperty float y\n"
           "property float z\nproperty float s\nproperty float t\nelement face 4\nproperty list uchar int "
           "vertex_indices\nend_header\n0 0 0 0 0\n.1 0 0 1 0\n0 .1 0 0 1\n0 0 .1 1 1\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 "
           "2 3\n"),
     kTrain, 0, "warning: .*cube\\.ply: its texture is left out: .*no\\.png", "new.resight"},

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
    {"EvaluateChangesWithoutAnnotation", write("tuw.changes", "cloud_00_cube_3.txt\n"),
     "evaluate --models models.resight --dataset tuw -k 0 --out out", 2,
     "tuw\\.changes: view 0 has no annotation of 'cube' with instance 3"},
    {"ConvertABrokenMesh", cut("meshes/cube.ply", 0.9), "convert meshes out --to bop", 2, "cube\\.ply: "},
    {"ConvertABrokenMeshToViews", cut("meshes/cube.ply", 0.9), "convert meshes out --to tuw", 2, "cube\\.ply: "},
    {"ViewNothing", kNothing, "view", 2, "view: inputs is required"},
    {"ViewMissing", kNothing, "view nowhere --no-open", 2, "nowhere: no such file or directory"},
    {"ViewEmpty", kNothing, "view empty --no-open", 2, "empty: is nothing to view \\(expected results"},
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
    {"PipeAsScript", pipe("s.toml"), "simulate s.toml --out out", 2, "s\\.toml: is not a file"},
    {"EmptyScript", write("s.toml", ""), "simulate s.toml --out out", 2, "s\\.toml: "},
};

std::ostream& operator<<(std::ostream& out, const Row& row) { return out << "resight " << row.command; }

// All entries below a folder with their sizes.
std::vector<std::string> list(const fs::path& folder) {
  std::vector<std::string> entries;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    entries.push_back(entry.path().lexically_relative(folder).string());
    std::error_code leads_nowhere;
    if (entry.is_regular_file(leads_nowhere)) entries.back().append(" ").append(std::to_string(entry.file_size()));
  }
  std::ranges::sort(entries);
  return entries;
}

struct Outcome {
  int status = -1;
  std::string output;
  std::vector<std::string> errors;  // Lines on standard error without progress.
};

// Input that should be rejected might run for hours instead; the time limit ends with status 124.
Outcome run(const fs::path& folder, const std::string& arguments) {
  const fs::path output = folder.string() + ".stdout";
  const fs::path errors = folder.string() + ".stderr";
  const std::string command = "cd " + folder.string() + " && timeout 60 " RESIGHT_PROGRAM " " + arguments + " >" +
                              output.string() + " 2>" + errors.string() + " </dev/null";
  const int code = std::system(command.c_str());
  Outcome outcome{WIFEXITED(code) ? WEXITSTATUS(code) : 128 + WTERMSIG(code), read_text(output), {}};
  std::istringstream lines(read_text(errors));
  static const std::regex progress("[a-z-]+ [0-9]+/[0-9]+: .*");
  for (std::string line; std::getline(lines, line);)
    if (!std::regex_match(line, progress)) outcome.errors.push_back(line);
  return outcome;
}

// A folder for all rows with the valid data; removed at the end.
class CommandLineFolder : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    root_ = fs::temp_directory_path() / ("resight_cli_" + std::to_string(::getpid()));
    fs::create_directories(root_);
    write_good_data(root_ / "good");
  }
  static void TearDownTestSuite() { fs::remove_all(root_); }
  void SetUp() override {
    folder_ = root_ / "run";
    fs::copy(root_ / "good", folder_, fs::copy_options::recursive);
  }
  void TearDown() override { fs::remove_all(folder_); }

  static fs::path root_;
  fs::path folder_;
};
fs::path CommandLineFolder::root_;
class CommandLineResults : public CommandLineFolder {};
class CommandLine : public CommandLineFolder, public testing::WithParamInterface<Row> {};

TEST_P(CommandLine, NamesWhatIsWrong) {
  const Row& row = GetParam();
  row.spoil(folder_);
  if (HasFatalFailure()) return;
  const std::vector<std::string> before = list(folder_);
  const Outcome outcome = run(folder_, row.command);
  EXPECT_EQ(outcome.status, row.status);
  if (*row.line == '\0') {
    EXPECT_EQ(outcome.errors, std::vector<std::string>{});
  } else {
    EXPECT_EQ(outcome.errors.size(), 1U);
    const std::string first = outcome.errors.empty() ? "" : outcome.errors[0];
    EXPECT_TRUE(std::regex_search(first, std::regex(std::string("^resight: .*") + row.line)))
        << "expected: /" << row.line << "/";
  }
  if (row.makes == nullptr) {
    EXPECT_EQ(list(folder_), before) << "files are left";
  } else {
    EXPECT_TRUE(fs::exists(folder_ / row.makes)) << "is missing: " << row.makes;
  }
  if (!HasFailure()) return;
  std::string told;
  for (const std::string& line : outcome.errors) told += "\n  stderr: " + line;
  ADD_FAILURE() << row << "\n  stdout: " << outcome.output << told;
}

INSTANTIATE_TEST_SUITE_P(Rows, CommandLine, testing::ValuesIn(kRows),
                         [](const auto& tested) { return std::string(tested.param.name); });

TEST_F(CommandLineResults, TheReportIsTitledAfterTheSequence) {
  const Outcome outcome = run(folder_, "recognize --models models.resight --sequence views/ --out out");
  ASSERT_EQ(outcome.status, 0) << testing::PrintToString(outcome.errors);
  EXPECT_THAT(read_text(folder_ / "out/report.html"), testing::HasSubstr("<title>resight: views</title>"));
}

TEST_F(CommandLineResults, ResultsOfARunBeforeAreReplacedAndOtherFilesStay) {
  for (int i = 0; i < 2; ++i)
    EXPECT_EQ(run(folder_, "recognize --models models.resight --sequence views --out full").status, 0);
  EXPECT_EQ(read_text(folder_ / "full/mine.txt"), "mine");
  EXPECT_EQ(list(folder_ / "full").size(), 6U) << testing::PrintToString(list(folder_ / "full"));
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
  EXPECT_EQ(nlohmann::json::parse(line)["format"], "resight trace 1");
  int num_views = 0;
  for (; std::getline(lines, line); ++num_views) EXPECT_EQ(nlohmann::json::parse(line)["view"], num_views);
  EXPECT_EQ(num_views, kViews);
  EXPECT_EQ(detections(), without);
  EXPECT_FALSE(fs::exists(folder_ / "out/trace.jsonl")) << "it would be taken for one of the new run";
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
  for (const char* command : {kConvert, kRecognize, kChanges}) {
    const Outcome outcome = run(folder_, command);
    EXPECT_EQ(outcome.status, 2) << command;
    EXPECT_THAT(testing::PrintToString(outcome.errors), testing::HasSubstr("another command is writing it")) << command;
  }
  EXPECT_TRUE(fs::is_empty(other->path()));
}

TEST_F(CommandLineResults, AClosedPipeEndsTheProgramAndLeavesOnlyFinishedViews) {
  const std::string command = "cd " + folder_.string() + " && { " RESIGHT_PROGRAM " " + kRecognize +
                              " --stream 2>/dev/null; echo $? >status; } | true";
  ASSERT_EQ(std::system(command.c_str()), 0);
  EXPECT_EQ(read_text(folder_ / "status"), std::to_string(128 + SIGPIPE) + "\n");
  EXPECT_THAT(list(folder_), testing::Not(testing::Contains(testing::HasSubstr("resight-partial"))));
  EXPECT_FALSE(fs::exists(folder_ / "out/summary.json"));
}

TEST_F(CommandLineResults, TrainingChecksEveryInputBeforeItBegins) {
  write_text(folder_ / "meshes/z.ply", "ply\n");
  EXPECT_EQ(run(folder_, kTrain).status, 2);
  EXPECT_THAT(read_text(folder_.string() + ".stderr"), testing::Not(testing::HasSubstr("train 1/2")));
}

TEST_F(CommandLineResults, NamesThatAreNotUtf8AreNoObstacle) {
  fs::rename(folder_ / "views", folder_ / "v\xff");
  EXPECT_EQ(
      run(folder_, "evaluate --models models.resight --dataset v$(printf '\\377') --presets mvr -k 0 --out out").status,
      0);
  EXPECT_TRUE(fs::exists(folder_ / "out/worst.md"));
}

TEST_F(CommandLineResults, ViewPrintsItsAddressAndEndsWhenInterrupted) {
  ASSERT_EQ(run(folder_, "recognize --models models.resight --sequence views --out out").status, 0);
  for (const char* input : {"out", "views", "models.resight", "meshes"}) {
    // Interrupted only after it has told its address: a busy machine may take seconds to start it.
    const std::string command = "cd " + folder_.string() + " && rm -f told && { " RESIGHT_PROGRAM " view --no-open " +
                                std::string(input) +
                                " >told 2>&1 </dev/null & } && for i in $(seq 600); do grep -q Ctrl-C told && break; "
                                "sleep 0.1; done; sleep 0.5; kill -INT $!; wait $!";
    EXPECT_EQ(std::system(command.c_str()), 0) << input;
    EXPECT_TRUE(std::regex_match(read_text(folder_ / "told"),
                                 std::regex("http://127\\.0\\.0\\.1:[0-9]+/#token=[0-9a-f]{32}\n.*Ctrl-C.*\n")))
        << input << ": " << read_text(folder_ / "told");
  }
}

}  // namespace
}  // namespace resight
