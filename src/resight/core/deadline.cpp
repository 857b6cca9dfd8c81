// SPDX-License-Identifier: Apache-2.0
#include "resight/core/deadline.hpp"

#include <chrono>

namespace resight {

double steady_clock_s() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

}  // namespace resight
