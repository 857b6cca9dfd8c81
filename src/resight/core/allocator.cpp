// SPDX-License-Identifier: Apache-2.0
#include "resight/core/allocator.hpp"

#include <climits>

#ifdef __GLIBC__
#include <malloc.h>
#endif

namespace resight {

bool keep_freed_memory() {
#ifdef __GLIBC__
  constexpr int kLargest = 1 << 30;  // Bytes. Smaller blocks are kept.
  // Bytes. Larger blocks are mapped on request; older versions of the library allow no more.
  constexpr int kLargestOnce = 32 << 20;
  const bool keeps_large = mallopt(M_MMAP_THRESHOLD, kLargest) == 1 || mallopt(M_MMAP_THRESHOLD, kLargestOnce) == 1;
  return mallopt(M_TRIM_THRESHOLD, INT_MAX) == 1 && keeps_large;
#else
  return false;
#endif
}

}  // namespace resight
