// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <functional>
#include <string>
#include <vector>

#include "cpu_clock.hpp"

namespace resight::bench {

/// One implementation of a stage.
struct Contestant {
  std::string name;
  /// Does the work, keeps its result, and returns its CPU time in seconds.
  std::function<double()> run;
  /// Accuracy of the result of the last run; called after all runs.
  std::function<std::string()> accuracy;
};

void print_table_head();

/// Runs the contestants in turn and prints a row for each: median CPU time, its ratio to that of the first, accuracy.
void compare(const std::string& stage, const std::vector<Contestant>& contestants);

/// CPU time of a call, in seconds.
template <typename Work>
double cpu_time_s(Work&& work) {
  const CpuClock clock;
  work();
  return clock.elapsed_s();
}

}  // namespace resight::bench
