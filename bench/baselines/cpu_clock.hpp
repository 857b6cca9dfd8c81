// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <ctime>

namespace resight::bench {

/// CPU time of the process since construction, over all threads. Hardly affected by other programs.
class CpuClock {
 public:
  [[nodiscard]] double elapsed_s() const { return static_cast<double>(std::clock() - start_) / CLOCKS_PER_SEC; }

 private:
  std::clock_t start_ = std::clock();
};

}  // namespace resight::bench
