// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <functional>
#include <string>
#include <vector>

#include "cpu_clock.hpp"

namespace resight::bench {

/// One way to do a stage.
struct Contestant {
  std::string name;
  std::function<double()> run;            ///< Does the work, keeps its result, and tells its CPU time in seconds.
  std::function<std::string()> accuracy;  ///< Of the result of its last run; asked when all have run.
};

void print_table_head();

/// Runs the contestants in turns and prints a row for each: median CPU time, its ratio to the first one's, accuracy.
void compare(const std::string& stage, const std::vector<Contestant>& contestants);

/// CPU time of a call, seconds.
template <typename Work>
double cpu_time_s(Work&& work) {
  const CpuClock clock;
  work();
  return clock.elapsed_s();
}

}  // namespace resight::bench
