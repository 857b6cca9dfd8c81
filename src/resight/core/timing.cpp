// SPDX-License-Identifier: Apache-2.0
#include "resight/core/timing.hpp"

#include <sys/resource.h>

#include <algorithm>
#include <ctime>

#include "resight/core/deadline.hpp"

namespace resight {
namespace {

double cpu_now_s() {
  timespec time{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

}  // namespace

void StageTimes::add(std::string_view stage, double wall_s, double cpu_s) {
  auto found = std::find_if(stages_.begin(), stages_.end(), [&](const StageTime& s) { return s.stage == stage; });
  if (found == stages_.end()) found = stages_.insert(stages_.end(), StageTime{std::string(stage), 0, 0});
  found->wall_s += wall_s;
  found->cpu_s += cpu_s;
}

void StageTimes::add(const StageTimes& other) {
  for (const StageTime& s : other.stages_) add(s.stage, s.wall_s, s.cpu_s);
}

double StageTimes::total_wall_s() const {
  double total = 0;
  for (const StageTime& s : stages_) total += s.wall_s;
  return total;
}

ScopedTimer::ScopedTimer(StageTimes& times, std::string_view stage)
    : times_(times), stage_(stage), start_wall_s_(steady_clock_s()), start_cpu_s_(cpu_now_s()) {}

ScopedTimer::~ScopedTimer() { times_.add(stage_, steady_clock_s() - start_wall_s_, cpu_now_s() - start_cpu_s_); }

std::size_t peak_memory_bytes() {
  rusage usage{};
  if (getrusage(RUSAGE_SELF, &usage) != 0) return 0;
  return static_cast<std::size_t>(usage.ru_maxrss) * 1024;
}

}  // namespace resight
