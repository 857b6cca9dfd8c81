// SPDX-License-Identifier: Apache-2.0
// The bias of the depth that measure_depth_bias() finds in sequences.
//   bench_depth_bias SEQUENCE...
#include "resight/registration/depth_bias.hpp"

#include <fmt/format.h>

#include "arguments.hpp"
#include "resight/core/timing.hpp"
#include "resight/io/sequence.hpp"

int main(int argc, char** argv) {
  using namespace resight;
  if (argc < 2) exit_with("usage: bench_depth_bias SEQUENCE...");
  RecognizerConfig config = preset_or_exit("default");
  config.set_num_threads(2);
  for (int a = 1; a < argc; ++a) {
    const auto sequence = open_or_exit(argv[a]);
    StageTimes times;
    DepthBias bias;
    {
      const ScopedTimer timer(times, "bias");
      bias = measure_depth_bias(*sequence, config.prepare, config.camera.depth_bias);
    }
    constexpr double kAt_m2 = 1.2 * 1.2;
    fmt::print("{}: {:.4f} +- {:.4f} 1/m, {:.1f} +- {:.1f} mm at 1.2 m, {} views, {}; {:.2f} s CPU\n", argv[a],
               bias.per_m, bias.sigma_per_m, 1e3 * kAt_m2 * bias.per_m, 1e3 * kAt_m2 * bias.sigma_per_m, bias.num_views,
               bias.is_significant() ? "corrected" : "left alone", times.stages().front().cpu_s);
  }
  return 0;
}
