// SPDX-License-Identifier: Apache-2.0
// Statistics of depth and colour cameras that can be measured on any sequence, real or simulated: noise of depth by
// range and angle, share and place of holes, spectrum of flat patches, overshoot at edges, brightness and colours.
// Prints a table in Markdown with one column per sequence.
//   bench_sensor_statistics [--views N] NAME=SEQUENCE...
#include <fmt/format.h>

#include <cmath>
#include <cstdlib>
#include <functional>
#include <string>
#include <vector>

#include "arguments.hpp"
#include "color_statistics.hpp"
#include "depth_statistics.hpp"
#include "resight/io/sequence.hpp"

namespace {

using namespace resight;  // NOLINT(google-build-using-namespace)

struct Column {
  std::string name;
  int num_views = 0;
  DepthStatistics depth;
  ColorStatistics color;
};

// Several sequences of one name, joined by commas, make one column.
Column measure(const std::string& argument, int max_views) {
  const std::size_t equals = argument.find('=');
  if (equals == std::string::npos) exit_with("'" + argument + "': expected NAME=SEQUENCE[,SEQUENCE...]");
  Column column;
  column.name = argument.substr(0, equals);
  std::string rest = argument.substr(equals + 1) + ",";
  for (std::size_t comma = rest.find(','); comma != std::string::npos; comma = rest.find(',')) {
    const auto sequence = value_or_exit(open_sequence(rest.substr(0, comma)));
    rest.erase(0, comma + 1);
    const int step = std::max(1, (sequence->num_views() + max_views - 1) / max_views);
    for (int view = 0; view < sequence->num_views(); view += step) {
      const RgbdFrame frame = value_or_exit(sequence->read_view(view));
      column.depth.add(frame);
      column.color.add(frame.color);
      ++column.num_views;
    }
  }
  return column;
}

std::string number(double value, int decimals) {
  return std::isnan(value) ? "-" : fmt::format("{:.{}f}", value, decimals);
}

void print_row(const std::string& name, const std::vector<Column>& columns, int decimals,
               const std::function<double(const Column&)>& value) {
  fmt::print("| {} |", name);
  for (const Column& column : columns) fmt::print(" {} |", number(value(column), decimals));
  fmt::print("\n");
}

void print_depth(const std::vector<Column>& columns) {
  using Depth = DepthStatistics;
  for (std::size_t i = 0; i + 1 < Depth::kRanges_m.size(); ++i)
    print_row(fmt::format("depth noise at {} to {} m, mm", Depth::kRanges_m[i], Depth::kRanges_m[i + 1]), columns, 2,
              [i](const Column& c) { return 1000 * c.depth.noise_m(i); });
  for (std::size_t i = 0; i + 1 < Depth::kAngles_deg.size(); ++i)
    print_row(fmt::format("the same / z², mm/m², at {} to {} deg", Depth::kAngles_deg[i], Depth::kAngles_deg[i + 1]),
              columns, 2, [i](const Column& c) { return 1000 * c.depth.noise_per_z_sq(i); });
  print_row("its correlation between neighbours", columns, 2, [](const Column& c) { return c.depth.correlation(); });
  print_row("holes, %", columns, 1, [](const Column& c) { return 100 * c.depth.hole_share(); });
  for (std::size_t i = 0; i + 1 < Depth::kAngles_deg.size(); ++i)
    print_row(fmt::format("holes at {} to {} deg, %", Depth::kAngles_deg[i], Depth::kAngles_deg[i + 1]), columns, 1,
              [i](const Column& c) { return 100 * c.depth.hole_share_at_angle(i); });
  const std::vector<std::string> distances{"less than 3 px", "3 to 8 px", "more than 8 px"};
  for (std::size_t i = 0; i < distances.size(); ++i)
    print_row("holes " + distances[i] + " from a depth edge, %", columns, 1,
              [i](const Column& c) { return 100 * c.depth.hole_share_at_edge_distance(i); });
  for (std::size_t i = 0; i + 1 < Depth::kBrightness.size(); ++i)
    print_row(fmt::format("holes at grey levels {} to {}, %", Depth::kBrightness[i], Depth::kBrightness[i + 1] - 1),
              columns, 1, [i](const Column& c) { return 100 * c.depth.hole_share_at_brightness(i); });
}

void print_color(const std::vector<Column>& columns) {
  print_row("noise of flat patches, grey levels", columns, 2, [](const Column& c) { return c.color.noise(); });
  for (std::size_t i = 0; i < ColorStatistics::kNumBands; ++i)
    print_row(fmt::format("its share at {} to {} cycles/px, %", 0.125 * static_cast<double>(i),
                          0.125 * static_cast<double>(i + 1)),
              columns, 0, [i](const Column& c) { return 100 * c.color.band_share(i); });
  print_row("overshoot at edges, median, %", columns, 1, [](const Column& c) { return 100 * c.color.overshoot(0.5); });
  print_row("overshoot at edges, 90th percentile, %", columns, 1,
            [](const Column& c) { return 100 * c.color.overshoot(0.9); });
  print_row("width of edges (10 to 90 %), px", columns, 2, [](const Column& c) { return c.color.rise_px(); });
  for (const double share : {0.05, 0.5, 0.95})
    print_row(fmt::format("brightness, {:.0f}th percentile", 100 * share), columns, 0,
              [share](const Column& c) { return c.color.brightness(share); });
  print_row("clipped (250 and more), %", columns, 1, [](const Column& c) { return 100 * c.color.clipped_share(); });
  for (const double share : {0.5, 0.9})
    print_row(fmt::format("saturation, {:.0f}th percentile", 100 * share), columns, 2,
              [share](const Column& c) { return c.color.saturation(share); });
  print_row("mean red / green", columns, 2, [](const Column& c) { return c.color.red_to_green(); });
  print_row("mean blue / green", columns, 2, [](const Column& c) { return c.color.blue_to_green(); });
}

}  // namespace

int main(int argc, char** argv) {
  int max_views = 20;
  std::vector<Column> columns;
  for (int i = 1; i < argc; ++i) {
    if (std::string(argv[i]) == "--views" && i + 1 < argc) {
      max_views = std::max(1, std::atoi(argv[++i]));
      continue;
    }
    columns.push_back(measure(argv[i], max_views));
  }
  if (columns.empty()) exit_with("usage: bench_sensor_statistics [--views N] NAME=SEQUENCE[,SEQUENCE...]...");
  fmt::print("| |");
  for (const Column& column : columns) fmt::print(" {} |", column.name);
  fmt::print("\n|---|");
  for (std::size_t i = 0; i < columns.size(); ++i) fmt::print("---|");
  fmt::print("\n");
  print_row("views", columns, 0, [](const Column& c) { return static_cast<double>(c.num_views); });
  print_depth(columns);
  print_color(columns);
  return 0;
}
