// SPDX-License-Identifier: Apache-2.0
// What the shape search alone finds of each object in single views: recall per object, and the number of hypotheses.
//   bench_shape_search SEQUENCE LIBRARY [config.toml|-] [every]
#include "resight/shape_search/shape_search.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <map>
#include <string>

#include "arguments.hpp"
#include "resight/io/sequence.hpp"
#include "resight/io/settings_file.hpp"
#include "resight/models/library_file.hpp"
#include "resight/models/pose_distance.hpp"
#include "resight/recognition/view_hypothesis_generator.hpp"

namespace {

using namespace resight;

struct Tally {
  int to_find = 0;
  int found = 0;
  int first = 0;
  int hypotheses = 0;
};

}  // namespace

int main(int argc, char** argv) {
  if (argc < 3) {
    fmt::print(stderr, "usage: bench_shape_search SEQUENCE LIBRARY [config.toml|-] [every]\n");
    return 2;
  }
  const auto sequence = value_or_exit(open_sequence(argv[1]));
  const ModelLibrary library = value_or_exit(load_library(argv[2]));
  RecognizerConfig config = preset_or_exit("default");
  if (argc > 3 && std::string(argv[3]) != "-") config = value_or_exit(read_settings(argv[3], config));
  const int every = argc > 4 ? std::max(1, std::atoi(argv[4])) : 1;
  config.set_num_threads(2);
  const auto start = std::chrono::steady_clock::now();
  const ShapeSearch search(library, config.shape, match_criteria(config.verify));
  const std::chrono::duration<double> built = std::chrono::steady_clock::now() - start;
  std::map<std::string, Tally> tallies;
  double seconds = 0;
  int views = 0;
  for (int v = 0; v < sequence->num_views(); v += every) {
    const PreparedView view = prepare_view(value_or_exit(sequence->read_view(v)), config.prepare);
    const auto begin = std::chrono::steady_clock::now();
    const SearchView searched(view, config.shape, library.largest_diameter_m());
    const auto candidates = search.search(searched);
    seconds += std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    ++views;
    for (const ShapeCandidate& c : candidates) ++tallies[library.objects[c.object].name].hypotheses;
    for (const GroundTruthObject& truth : value_or_exit(sequence->read_ground_truth(v))) {
      if (truth.visible_share < 0.05 || library.find(truth.object) < 0) continue;
      const int object = library.find(truth.object);
      Tally& tally = tallies[truth.object];
      ++tally.to_find;
      int rank = 0;
      std::string line;
      bool hit = false;
      for (const ShapeCandidate& c : candidates) {
        if (c.object != object) continue;
        const PoseDifference difference =
            compare_poses(c.camera_from_object, truth.camera_from_object, library.objects[object]);
        const bool right = difference.center_distance_m < 0.02 && difference.rotation_rad < 0.26;
        line += fmt::format(" {}{:.2f}({},{:.0f}mm,{:.0f}deg)", right ? "*" : "", c.quality, c.num_explained,
                            1e3 * difference.center_distance_m, 57.3 * difference.rotation_rad);
        if (right && !hit) {
          hit = true;
          ++tally.found;
          tally.first += rank == 0 ? 1 : 0;
        }
        ++rank;
      }
      const auto trial = search.score_pose(searched, object, truth.camera_from_object);
      fmt::print(
          "view {:2} {:14} vis {:.2f} {} | {} facing {} confirmed {} wrong color {} seen through {} occluded | "
          "explained {:.2f} of "
          "{:.2f} pattern {:.2f} |{}\n",
          v, truth.object, truth.visible_share, hit ? "found" : "LOST ", trial.coarse.facing, trial.coarse.confirmed,
          trial.coarse.wrong_color, trial.coarse.seen_through, trial.coarse.occluded, trial.fit.explained_share,
          trial.fit.visible_share, trial.fit.pattern_similarity, line);
    }
  }
  Tally sum;
  for (const auto& [name, t] : tallies) {
    fmt::print("{:14} found {:3} of {:3}, first {:3}, hypotheses per view {:.1f}\n", name, t.found, t.to_find, t.first,
               static_cast<double>(t.hypotheses) / views);
    sum = {sum.to_find + t.to_find, sum.found + t.found, sum.first + t.first, sum.hypotheses + t.hypotheses};
  }
  fmt::print("found {} of {} ({:.3f}), first {}; {:.1f} hypotheses, {:.3f} s per view; built in {:.2f} s\n", sum.found,
             sum.to_find, static_cast<double>(sum.found) / sum.to_find, sum.first,
             static_cast<double>(sum.hypotheses) / views, seconds / views, built.count());
  return 0;
}
