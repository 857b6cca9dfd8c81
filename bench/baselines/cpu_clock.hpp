// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <ctime>

namespace resight::bench {

/// CPU time of the process, all threads, since construction: what other programs of the machine do hardly counts.
class CpuClock {
 public:
  [[nodiscard]] double elapsed_s() const { return static_cast<double>(std::clock() - start_) / CLOCKS_PER_SEC; }

 private:
  std::clock_t start_ = std::clock();
};

}  // namespace resight::bench
