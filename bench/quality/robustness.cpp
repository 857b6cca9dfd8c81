// SPDX-License-Identifier: Apache-2.0
// Results of each preset on a sequence with degraded views, as a table: wrong camera poses, regions without return, no
// returns on grazing surfaces, none near edges (which removes thin objects).
//   resight simulate --preset dynamic-tabletop --seed 1 --format bop --out validation
//   resight train validation/models --out models.resight
//   bench_robustness validation/test/000001 models.resight [presets] [K] [events.json] [part of a trouble's name]
#include <fmt/format.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <sstream>
#include <string>
#include <vector>

#include "arguments.hpp"
#include "resight/core/random.hpp"
#include "resight/evaluation/evaluate_sequence.hpp"
#include "resight/io/sequence.hpp"
#include "resight/models/library_file.hpp"
#include "resight/sensor/prepared_view.hpp"

namespace {

using namespace resight;

constexpr float kNoReturn = std::numeric_limits<float>::quiet_NaN();
constexpr double kRadPerDeg = 0.0174533;

/// How views are degraded.
struct Trouble {
  std::string name;
  double pose_error_m = 0;    ///< Error of each camera position, in a random direction.
  double pose_error_rad = 0;  ///< Error of each camera rotation, about a random axis.
  double hole_share = 0;      ///< Share of the image without return, in discs.
  /// Largest angle between normal and viewing ray with a return.
  double max_slant_rad = 4;
  double min_edge_distance_px = 0;  ///< Points nearer to a depth edge have no return.
};

const std::vector<Trouble> kTroubles = {
    {.name = "none"},
    {.name = "poses off by 2 mm, 0.2 deg", .pose_error_m = 0.002, .pose_error_rad = 0.2 * kRadPerDeg},
    {.name = "poses off by 5 mm, 0.5 deg", .pose_error_m = 0.005, .pose_error_rad = 0.5 * kRadPerDeg},
    {.name = "poses off by 1 cm, 1 deg", .pose_error_m = 0.01, .pose_error_rad = 1 * kRadPerDeg},
    {.name = "no return from a tenth", .hole_share = 0.1},
    {.name = "no return from a third", .hole_share = 0.33},
    {.name = "no return beyond 60 deg", .max_slant_rad = 60 * kRadPerDeg},
    {.name = "no return beyond 45 deg", .max_slant_rad = 45 * kRadPerDeg},
    {.name = "no return within 2 px of edges", .min_edge_distance_px = 2},
    {.name = "no return within 4 px of edges", .min_edge_distance_px = 4},
};

Eigen::Vector3d random_direction(Rng& rng) {
  return Eigen::Vector3d{rng.normal(), rng.normal(), rng.normal()}.normalized();
}

void punch_holes(double share, Rng& rng, Image<float>& depth_m) {
  constexpr int kMinRadius_px = 8;
  constexpr int kMaxRadius_px = 30;
  const auto wanted = static_cast<std::size_t>(share * static_cast<double>(depth_m.size()));
  Image<std::uint8_t> hole(depth_m.width(), depth_m.height());
  for (std::size_t done = 0; done < wanted;) {
    const int u0 = static_cast<int>(rng.below(static_cast<std::uint32_t>(depth_m.width())));
    const int v0 = static_cast<int>(rng.below(static_cast<std::uint32_t>(depth_m.height())));
    const int radius = kMinRadius_px + static_cast<int>(rng.below(kMaxRadius_px - kMinRadius_px));
    for (int v = std::max(0, v0 - radius); v < std::min(depth_m.height(), v0 + radius); ++v)
      for (int u = std::max(0, u0 - radius); u < std::min(depth_m.width(), u0 + radius); ++u) {
        if ((u - u0) * (u - u0) + (v - v0) * (v - v0) > radius * radius || hole(u, v) != 0) continue;
        hole(u, v) = 1;
        depth_m(u, v) = kNoReturn;
        ++done;
      }
  }
}

void drop_badly_seen(const Trouble& trouble, RgbdFrame& frame) {
  const PreparedView view = prepare_view(frame);
  const auto min_cosine = static_cast<float>(std::cos(trouble.max_slant_rad));
  for (std::size_t i = 0; i < frame.depth_m.size(); ++i) {
    const bool slanted = trouble.max_slant_rad < 3 && view.cloud.has_normal(i) &&
                         -view.cloud.normal(i).dot(view.cloud.point(i).normalized()) < min_cosine;
    if (slanted || view.edge_distance_px[i] < static_cast<float>(trouble.min_edge_distance_px))
      frame.depth_m[i] = kNoReturn;
  }
}

/// Degraded views of another sequence; each view is always degraded in the same way.
class SpoiledSequence : public Sequence {
 public:
  SpoiledSequence(const Sequence& original, Trouble trouble) : original_(original), trouble_(std::move(trouble)) {}
  [[nodiscard]] std::string format() const override { return original_.format(); }
  [[nodiscard]] int num_views() const override { return original_.num_views(); }
  [[nodiscard]] std::string view_name(int view) const override { return original_.view_name(view); }
  [[nodiscard]] Result<RgbdFrame> read_view(int view) const override {
    Result<RgbdFrame> frame = original_.read_view(view);
    if (!frame.ok()) return frame;
    Rng rng = Rng::stream(1, static_cast<std::uint64_t>(view));
    const Rigid3 error = {Rigid3::from_axis_angle(random_direction(rng), trouble_.pose_error_rad).rotation,
                          trouble_.pose_error_m * random_direction(rng)};
    frame->world_from_camera = frame->world_from_camera * error;
    if (trouble_.hole_share > 0) punch_holes(trouble_.hole_share, rng, frame->depth_m);
    if (trouble_.max_slant_rad < 3 || trouble_.min_edge_distance_px > 0) drop_badly_seen(trouble_, *frame);
    return frame;
  }

 private:
  const Sequence& original_;
  Trouble trouble_;
};

void print_row(const Trouble& trouble, const EvaluatedRun& run) {
  RecognitionScore score;
  int fewest = std::numeric_limits<int>::max();
  for (const EvaluatedView& view : run.views) {
    score += view.score;
    fewest = std::min(fewest, view.counts.accepted);
  }
  fmt::print("| {} | `{}` | {:.3f} | {:.3f} | {:.3f} | {} | {} |", trouble.name, run.preset, score.precision(),
             score.recall(), score.f_score(), run.num_ghosts(), fewest);
  if (run.has_changes)
    fmt::print(" {:.3f} | {:.3f} |\n", run.events.events.precision(), run.events.events.recall());
  else
    fmt::print(" - | - |\n");
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 3)
    exit_with("usage: bench_robustness SEQUENCE LIBRARY [presets] [K] [events.json] [part of a trouble's name]");
  const auto sequence = value_or_exit(open_sequence(argv[1]));
  const ModelLibrary library = value_or_exit(load_library(argv[2]));
  const SequenceTruth truth =
      value_or_exit(read_sequence_truth(*sequence, library, {.events = argc > 5 ? argv[5] : "", .changes = {}}));
  std::vector<RecognizerConfig> configs;
  std::istringstream presets(argc > 3 ? argv[3] : "mvr,mvr-chd,default");
  for (std::string name; std::getline(presets, name, ',');) {
    configs.push_back(preset_or_exit(name));
    if (argc > 4) configs.back().num_previous_views = std::atoi(argv[4]);
    configs.back().set_num_threads(2);
  }
  fmt::print(
      "| trouble | preset | precision | recall | F | ghosts | fewest objects per view | event precision | event "
      "recall |\n|---|---|---|---|---|---|---|---|---|\n");
  const std::string wanted = argc > 6 ? argv[6] : "";
  for (const Trouble& trouble : kTroubles)
    for (const RecognizerConfig& config : configs) {
      if (trouble.name.find(wanted) == std::string::npos) continue;
      const SpoiledSequence spoiled(*sequence, trouble);
      EvaluateSequenceOptions options;
      options.find_losses = false;
      print_row(trouble, value_or_exit(evaluate_sequence(spoiled, truth, library, config, options)));
    }
  return 0;
}
