// SPDX-License-Identifier: Apache-2.0
// Change detection on real recordings, with camera poses corrected as the preset does. Prints tables in Markdown.
//   bench_real_changes still SEQUENCE LABELS_DIR [preset] [config.toml|-] [K] [--pictures DIR]
// A still camera, with a class mask LABELS_DIR/<view>.png per view: compares the changes of each view with those of
// the class masks, beside a plain depth difference of 12 mm. --pictures: sheets of all misses and false reports.
//   bench_real_changes static SEQUENCE [preset] [config.toml|-] [K]
// A camera in a static scene: whatever is reported as changed is false.
// SEQUENCE@SENSOR assumes the depth noise of that kind of camera (`--sensor`).
#include <fmt/format.h>

#include <cstdlib>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "arguments.hpp"
#include "real_changes/change_run.hpp"
#include "real_changes/change_scores.hpp"
#include "real_changes/picture_sheets.hpp"
#include "real_changes/static_shares.hpp"
#include "resight/io/sequence.hpp"
#include "resight/io/settings_file.hpp"

namespace {

using namespace resight;
using namespace resight::bench;

// More than 12 mm. Depth comes in whole millimetres, so that rounding errors would decide at 12 mm exactly.
constexpr float kPlainThreshold_m = 0.01205F;

struct Arguments {
  std::vector<std::string> positional;
  std::string pictures;  ///< Folder, or empty.
  [[nodiscard]] std::string at(std::size_t i, const std::string& otherwise) const {
    return i < positional.size() ? positional[i] : otherwise;
  }
};

Arguments parse_arguments(int argc, char** argv) {
  Arguments arguments;
  for (int i = 1; i < argc; ++i) {
    if (std::string_view(argv[i]) == "--pictures" && i + 1 < argc)
      arguments.pictures = argv[++i];
    else
      arguments.positional.emplace_back(argv[i]);
  }
  return arguments;
}

// Preset, settings file and K are positional arguments from `first` on.
RecognizerConfig read_config(const Arguments& arguments, std::size_t first) {
  RecognizerConfig config = preset_or_exit(arguments.at(first, "default"));
  const std::string file = arguments.at(first + 1, "-");
  if (file != "-") config = value_or_exit(read_settings(file, config));
  if (first + 2 < arguments.positional.size())
    config.num_previous_views = std::atoi(arguments.positional[first + 2].c_str());
  config.set_num_threads(2);
  config.check();
  return config;
}

LabelledView read_labelled_view(const Sequence& sequence, int view, const std::filesystem::path& labels) {
  LabelledView labelled{value_or_exit(sequence.read_view(view)), {}};
  const std::filesystem::path file = labels / (labelled.frame.name + ".png");
  labelled.classes = value_or_exit(read_classes(file));
  if (labelled.classes.width() != labelled.frame.camera.width ||
      labelled.classes.height() != labelled.frame.camera.height)
    exit_with(fmt::format("{}: does not have the size of the view", file.string()));
  return labelled;
}

// Nearer than before by more than the threshold: added. Farther: removed.
ReportedChanges find_depth_difference(const Image<float>& before_m, const Image<float>& after_m) {
  const Mask none(after_m.width(), after_m.height(), 0);
  ReportedChanges reported{{none, none}, {}};
  for (std::size_t i = 0; i < none.size(); ++i) {
    reported.masks[kAdded][i] = before_m[i] - after_m[i] > kPlainThreshold_m;
    reported.masks[kRemoved][i] = after_m[i] - before_m[i] > kPlainThreshold_m;
  }
  for (const Side side : kSides) reported.regions[side] = find_components(reported.masks[side]);
  return reported;
}

ReportedChanges to_reported(const ChangeRun& run, const ChangeResult& changes) {
  const Camera& camera = run.frame().camera;
  const Components none{{}, Image<int>(camera.width, camera.height, -1)};
  const Mask empty(camera.width, camera.height, 0);
  ReportedChanges reported{{changes.novel_mask.empty() ? empty : changes.novel_mask,
                            changes.removed_mask.empty() ? empty : changes.removed_mask},
                           {none, none}};
  for (ChangeRegion& region : run.find_regions(changes)) {
    Components& of_side = reported.regions[region.kind == RegionKind::kNovel ? kAdded : kRemoved];
    for (const int pixel : region.pixels) of_side.numbers[pixel] = static_cast<int>(of_side.regions.size());
    of_side.regions.push_back(std::move(region.pixels));
  }
  return reported;
}

std::string format_share(const Count& count) { return count.total > 0 ? fmt::format("{:.3f}", count.share()) : "-"; }
std::string format_count(const Count& count) { return fmt::format("{} of {}", count.num, count.total); }

// All counts of a score, in the order of the columns of print_scores().
std::vector<Count> list_counts(const ChangeScore& score) {
  const auto& [added, removed] = score.sides;
  return {added.precision,
          added.recall,
          removed.precision,
          removed.recall,
          added.thin,
          added.tall,
          removed.thin,
          removed.tall,
          score.unchanged,
          score.false_in_class,
          added.region_precision,
          added.region_recall,
          removed.region_precision,
          removed.region_recall};
}

// As a table, and as numbers for scripts/real_results.sh.
void print_scores(const std::vector<std::pair<std::string, ChangeScore>>& scores) {
  constexpr std::size_t kNumShares = 4;
  fmt::print(
      "| method | added P | added R | removed P | removed R | thin added, found | tall added | thin removed | tall "
      "removed | unchanged called changed | false pixels on the same class | added regions right | found | removed "
      "regions right | found |\n|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|\n");
  for (const auto& [method, score] : scores) {
    const std::vector<Count> counts = list_counts(score);
    fmt::print("| {} |", method);
    for (std::size_t i = 0; i < counts.size(); ++i)
      fmt::print(" {} |", i < kNumShares ? format_share(counts[i]) : format_count(counts[i]));
    fmt::print("\n");
  }
  fmt::print("\n");
  for (const auto& [method, score] : scores) {
    fmt::print("counts {}", method);
    for (const Count& count : list_counts(score)) fmt::print(" {} {}", count.num, count.total);
    fmt::print("\n");
  }
}

void run_still(const Arguments& arguments) {
  const auto sequence = open_or_exit(arguments.positional[1]);
  const std::filesystem::path labels = arguments.positional[2];
  const RecognizerConfig config = read_config(arguments, 3);
  ChangeRun run(config, *sequence);
  ChangeScore plain;
  ChangeScore detected;
  PictureSheets sheets;
  int num_suspect = 0;
  std::optional<LabelledView> before;
  for (int v = 0; v < sequence->num_views(); ++v) {
    LabelledView after = read_labelled_view(*sequence, v, labels);
    const ChangeResult changes = run.add_view(after.frame);
    num_suspect += changes.pose_suspect ? 1 : 0;
    if (before) {
      const ChangeTruth truth = find_change_truth(*before, after);
      score_changes(truth, find_depth_difference(before->frame.depth_m, after.frame.depth_m), plain, nullptr);
      const ReportedChanges reported = to_reported(run, changes);
      std::vector<Mistake> mistakes;
      score_changes(truth, reported, detected, arguments.pictures.empty() ? nullptr : &mistakes);
      for (const Mistake& mistake : mistakes) sheets.add(*before, after, truth, reported, mistake);
    }
    before = std::move(after);
  }
  fmt::print("{} views, K = {}: camera pose corrected in {}, suspect in {}\n\n", sequence->num_views(),
             config.num_previous_views, run.num_corrected(), num_suspect);
  print_scores({{"plain", plain}, {arguments.at(3, "default"), detected}});
  if (arguments.pictures.empty()) return;
  if (const auto done = sheets.write(arguments.pictures); !done) exit_with(done.error().message);
}

void run_static(const Arguments& arguments) {
  const auto sequence = value_or_exit(open_posed_sequence(arguments.positional[1]));
  const RecognizerConfig config = read_config(arguments, 2);
  ChangeRun run(config, *sequence);
  FalseShares novel;
  FalseShares removed;
  int num_suspect = 0;
  for (int v = 0; v < sequence->num_views(); ++v) {
    const ChangeResult changes = run.add_view(value_or_exit(sequence->read_view(v)));
    num_suspect += changes.pose_suspect ? 1 : 0;
    if (v == 0) continue;  // Nothing to compare with.
    const Image<float>& depth_m = run.frame().depth_m;
    const double novel_share = novel.add_view(depth_m, changes.novel_mask);
    const double removed_share = removed.add_view(depth_m, changes.removed_mask);
    fmt::print("{}: {:.2f} % novel, {:.2f} % removed{}\n", run.frame().name, 100 * novel_share, 100 * removed_share,
               changes.pose_suspect ? ", camera pose suspect" : "");
  }
  fmt::print("\n{} views, K = {}: camera pose corrected in {}, suspect in {}\n\n", sequence->num_views(),
             config.num_previous_views, run.num_corrected(), num_suspect);
  const std::string method = arguments.at(2, "default");
  print_false_shares({{method + ", novel", novel}, {method + ", removed", removed}});
}

}  // namespace

int main(int argc, char** argv) {
  const Arguments arguments = parse_arguments(argc, argv);
  const std::string mode = arguments.at(0, "");
  try {
    if (mode == "still" && arguments.positional.size() > 2)
      run_still(arguments);
    else if (mode == "static" && arguments.positional.size() > 1)
      run_static(arguments);
    else
      exit_with(
          "usage: bench_real_changes still SEQUENCE LABELS_DIR [preset] [config.toml|-] [K] [--pictures DIR]\n"
          "       bench_real_changes static SEQUENCE [preset] [config.toml|-] [K]");
  } catch (const std::invalid_argument& error) {
    exit_with(error.what());
  }
  return 0;
}
