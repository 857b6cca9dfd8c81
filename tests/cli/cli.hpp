// SPDX-License-Identifier: Apache-2.0
// Invalid input to the command line, one row per error. Each row runs the program in its own folder with valid data, of
// which the row damages something, and defines the exit status, the single line on standard error, and that no files
// are left.
#pragma once
#include <unistd.h>

#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "resight/geometry/triangle_mesh.hpp"
#include "resight/models/object_model.hpp"

namespace resight::cli_test {

namespace fs = std::filesystem;
using Json = nlohmann::json;

inline constexpr int kWidth = 64;
inline constexpr int kHeight = 48;
inline constexpr int kViews = 3;
/// No file system takes it.
inline const std::string kLongName(300, 'a');
inline constexpr const char* kUnorganizedPcd =
    "VERSION .7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 4\nHEIGHT 1\nPOINTS 4\nDATA ascii\n"
    "0 0 0\n.1 0 0\n0 .1 0\n0 0 .1\n";

// ---- Small valid data: the content of each row's folder before it is damaged.

/// A cube of 8 cm around the origin. The sides share no vertices, so that edges are sharp.
[[nodiscard]] TriangleMesh make_cube(float metre);
[[nodiscard]] ModelLibrary make_library(int num_features);
void write_good_data(const fs::path& folder);

void write_text(const fs::path& file, const std::string& text);
[[nodiscard]] std::string read_text(const fs::path& file);

// ---- Ways to damage it.

using Spoil = std::function<void(const fs::path& folder)>;

[[nodiscard]] Spoil remove(const char* path);
[[nodiscard]] Spoil write(const char* path, const char* text);
[[nodiscard]] Spoil cut(const char* path, double share);
/// A pipe without a writer: whoever opens it waits for ever.
[[nodiscard]] Spoil pipe(const char* path);
/// Flips one bit of the byte at this share of the file.
[[nodiscard]] Spoil flip(const char* path, double share);
[[nodiscard]] Spoil replace(const char* path, const char* what, const char* by);
/// Edits the entry of the second view in a JSON file of the BOP scene.
[[nodiscard]] Spoil edit(const char* path, const std::function<void(Json&)>& change);
[[nodiscard]] Spoil link(const char* path, const char* target);
[[nodiscard]] Spoil both(const Spoil& first, const Spoil& second);
[[nodiscard]] Spoil move(const char* from, const char* to);
[[nodiscard]] Spoil copy(const char* from, const char* to);
[[nodiscard]] Spoil remove_texts(const char* path);
[[nodiscard]] Spoil small_image(const char* path);
[[nodiscard]] Spoil no_depth_at_all();
[[nodiscard]] Spoil library(const std::function<ModelLibrary()>& make);
[[nodiscard]] Spoil mesh(const char* path, const std::function<TriangleMesh()>& make);
inline const Spoil kNothing = [](const fs::path&) {};

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

inline constexpr const char* kRecognize = "recognize --models models.resight --sequence views --out out";
inline constexpr const char* kRecognizeTuw = "recognize --models models.resight --sequence tuw --out out";
inline constexpr const char* kChanges = "changes --sequence views --out out";
inline constexpr const char* kEvaluate =
    "evaluate --models models.resight --dataset views --presets mvr -k 0 --out out";
inline constexpr const char* kChangesTuw = "changes --sequence tuw --out out";
inline constexpr const char* kChangesTum = "changes --sequence tum --out out";
inline constexpr const char* kConvert = "convert views out --to tuw";
inline constexpr const char* kTrain = "train meshes --out new.resight";

struct Outcome {
  int status = -1;
  std::string output;
  std::vector<std::string> errors;  // Lines on standard error without progress.
};

/// Input that should be rejected might run for hours instead; the time limit ends with status 124.
[[nodiscard]] Outcome run(const fs::path& folder, const std::string& arguments);

/// All entries below a folder with their sizes.
[[nodiscard]] std::vector<std::string> list(const fs::path& folder);

/// A folder for all rows with the valid data; removed at the end.
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

class CommandLineResults : public CommandLineFolder {};
/// Its one test is in cli.cpp.
class CommandLine : public CommandLineFolder, public testing::WithParamInterface<Row> {};

inline std::string name_of_row(const testing::TestParamInfo<Row>& tested) { return tested.param.name; }

}  // namespace resight::cli_test
