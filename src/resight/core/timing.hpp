// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <string_view>
#include <vector>

namespace resight {

/// Wall and CPU time (all threads of the process) of one named stage, in seconds.
struct StageTime {
  std::string stage;
  double wall_s = 0;
  double cpu_s = 0;
};

/// Times of a run: one entry per stage, in order of first use. Repeated measurements of a stage are added up.
class StageTimes {
 public:
  void add(std::string_view stage, double wall_s, double cpu_s);
  void add(const StageTimes& other);
  [[nodiscard]] const std::vector<StageTime>& stages() const { return stages_; }
  /// Sum over all stages.
  [[nodiscard]] double total_wall_s() const;

 private:
  std::vector<StageTime> stages_;
};

/// Measures the scope that it lives in: `const ScopedTimer timer(times, "normals");`
class ScopedTimer {
 public:
  ScopedTimer(StageTimes& times, std::string_view stage);
  ~ScopedTimer();
  ScopedTimer(const ScopedTimer&) = delete;
  ScopedTimer& operator=(const ScopedTimer&) = delete;

 private:
  StageTimes& times_;
  std::string stage_;
  double start_wall_s_;
  double start_cpu_s_;
};

/// Peak resident memory of this process in bytes; 0 if the system does not report it.
[[nodiscard]] std::size_t peak_memory_bytes();

}  // namespace resight
