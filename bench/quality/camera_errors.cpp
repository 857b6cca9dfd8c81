// SPDX-License-Identifier: Apache-2.0
// The errors of the camera that measure_camera_errors() finds in sequences.
//   bench_camera_errors SEQUENCE...
#include "resight/registration/camera_errors.hpp"

#include <fmt/format.h>

#include "arguments.hpp"
#include "resight/core/timing.hpp"

int main(int argc, char** argv) {
  using namespace resight;
  if (argc < 2) exit_with("usage: bench_camera_errors SEQUENCE...");
  RecognizerConfig config = preset_or_exit("default");
  config.set_num_threads(2);
  for (int a = 1; a < argc; ++a) {
    const auto sequence = open_or_exit(argv[a]);
    StageTimes times;
    CameraErrors errors;
    {
      const ScopedTimer timer(times, "errors");
      errors = measure_camera_errors(*sequence, config.prepare, config.camera.color_offset, config.camera.depth_bias);
    }
    constexpr double kAt_m2 = 1.2 * 1.2;
    const ColorOffset& colors = errors.color_offset;
    const DepthBias& bias = errors.depth_bias;
    fmt::print("{}: colours {:+.2f} {:+.2f} +- {:.2f} {:.2f} px, corrected {:+.2f} {:+.2f}\n", argv[a],
               colors.offset_px.x(), colors.offset_px.y(), colors.sigma_px.x(), colors.sigma_px.y(),
               colors.corrected_px().x(), colors.corrected_px().y());
    fmt::print("  depth {:.4f} +- {:.4f} 1/m, {:.1f} +- {:.1f} mm at 1.2 m, {} views, {}; {:.2f} s CPU\n", bias.per_m,
               bias.sigma_per_m, 1e3 * kAt_m2 * bias.per_m, 1e3 * kAt_m2 * bias.sigma_per_m, bias.num_views,
               bias.is_significant() ? "corrected" : "left alone", times.stages().front().cpu_s);
  }
  return 0;
}
