// SPDX-License-Identifier: Apache-2.0
// Compares each stage with its counterparts in PCL and OpenCV, in one table: CPU time (median of alternating runs, one
// thread each) and accuracy on the same input. Without arguments: two views of the generated demo scene, with ground
// truth.
//   bench_baselines [SEQUENCE BEFORE VIEW [LIBRARY]]
#include <cstdlib>

#include "../quality/arguments.hpp"
#include "contest.hpp"
#include "stages.hpp"

namespace {

using namespace resight;
using namespace resight::bench;

StageInput input_of(int argc, char** argv) {
  if (argc == 1) return make_demo_input();
  if (argc != 4 && argc != 5) exit_with("usage: bench_baselines [SEQUENCE BEFORE VIEW [LIBRARY]]");
  return read_input(argv[1], std::atoi(argv[2]), std::atoi(argv[3]), argc > 4 ? argv[4] : "");
}

}  // namespace

int main(int argc, char** argv) {
  const StageInput input = input_of(argc, argv);
  print_table_head();
  compare_sampling(input);
  compare_normals(input);
  compare_shot(input);
  if (!input.library.objects.empty()) {
    compare_matching(input);
    compare_grouping(input);
    compare_verification(input);
    compare_refinement(input);
  }
  compare_differences(input);
  return 0;
}
