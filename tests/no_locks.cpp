// SPDX-License-Identifier: Apache-2.0
// Preloaded, it makes every file system one without locks, as some network file systems are.
#include <cerrno>

extern "C" int flock(int /*descriptor*/, int /*operation*/) {
  errno = ENOLCK;
  return -1;
}
