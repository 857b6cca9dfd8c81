// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <unistd.h>

#include <fstream>

namespace resight {

/// Current resident memory of the process in MB (10^6 bytes).
inline double memory_in_use_mb() {
  std::ifstream file("/proc/self/statm");
  double all = 0;
  double resident = 0;
  file >> all >> resident;
  return 1e-6 * resident * static_cast<double>(sysconf(_SC_PAGESIZE));
}

}  // namespace resight
