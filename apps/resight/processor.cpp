// SPDX-License-Identifier: Apache-2.0
#include "processor.hpp"

#ifdef __x86_64__
#include <unistd.h>

namespace {

// Only this file is compiled for any x86-64 processor (CMakeLists.txt). The function runs before all other code,
// including static initialisers of other files, which would otherwise end with an illegal instruction.
[[gnu::constructor(101)]] void check_processor() {
  __builtin_cpu_init();
  if (!resight::app::kNeedsAvx2 ||
      (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") && __builtin_cpu_supports("bmi2")))
    return;
  static constexpr char kMessage[] =
      "resight: built for processors with AVX2 and FMA, which this processor lacks (build it here, or with "
      "-DRESIGHT_MARCH=)\n";
  (void)!write(STDERR_FILENO, kMessage, sizeof kMessage - 1);
  _exit(1);
}

}  // namespace
#endif
