// SPDX-License-Identifier: Apache-2.0
#include "contest.hpp"

#include <fmt/format.h>

#include <cstdio>
#include <numeric>

#include "resight/core/statistics.hpp"

namespace resight::bench {
namespace {

constexpr std::size_t kNumRuns = 7;
// For slow contestants, see kEnoughTime_s.
constexpr std::size_t kMinRuns = 3;
constexpr double kEnoughTime_s = 10.0;  // CPU time after which kMinRuns suffice.

bool has_run_enough(const std::vector<double>& times_s) {
  return times_s.size() >= kNumRuns ||
         (times_s.size() >= kMinRuns && std::accumulate(times_s.begin(), times_s.end(), 0.0) > kEnoughTime_s);
}

}  // namespace

void print_table_head() { fmt::print("| stage | done by | CPU, ms | times | accuracy |\n|---|---|---|---|---|\n"); }

void compare(const std::string& stage, const std::vector<Contestant>& contestants) {
  std::vector<std::vector<double>> times_s(contestants.size());
  for (std::size_t run = 0; run < kNumRuns; ++run)
    for (std::size_t c = 0; c < contestants.size(); ++c)
      if (!has_run_enough(times_s[c])) times_s[c].push_back(contestants[c].run());
  for (std::size_t c = 0; c < contestants.size(); ++c) {
    const double cpu_s = upper_median(times_s[c]);
    fmt::print("| {} | {} | {:.1f} | {:.2f} | {} |\n", c == 0 ? stage : "", contestants[c].name, 1e3 * cpu_s,
               cpu_s / upper_median(times_s[0]), contestants[c].accuracy());
  }
  std::fflush(stdout);
}

}  // namespace resight::bench
