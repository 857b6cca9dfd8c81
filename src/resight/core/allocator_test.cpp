// SPDX-License-Identifier: Apache-2.0
#include "resight/core/allocator.hpp"

#include <gtest/gtest.h>
#include <sys/resource.h>

#include <cstddef>
#include <cstdlib>
#include <utility>

namespace resight {
namespace {

// Sanitizers replace the allocator.
#if defined(__has_feature)
#define RESIGHT_HAS_FEATURE(x) __has_feature(x)
#else
#define RESIGHT_HAS_FEATURE(x) 0
#endif
#if defined(__GLIBC__) && !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__) && \
    !RESIGHT_HAS_FEATURE(address_sanitizer) && !RESIGHT_HAS_FEATURE(thread_sanitizer)

long num_page_faults() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return usage.ru_minflt;
}

// Number of page faults while one more array of 48 MB is allocated, written completely and freed.
long faults_of_large_array() {
  constexpr std::size_t kBytes = 48'000'000;
  const long before = num_page_faults();
  auto* array = static_cast<volatile char*>(std::malloc(kBytes));
  for (std::size_t i = 0; i < kBytes; i += 1024) array[i] = 1;
  std::free(const_cast<char*>(array));
  return num_page_faults() - before;
}

TEST(KeepFreedMemory, PagesOfTheLastArrayServeTheNext) {
  static bool is_first_run = true;  // The setting outlives the test.
  if (std::exchange(is_first_run, false)) {
    EXPECT_GT(faults_of_large_array(), 20);
    EXPECT_GT(faults_of_large_array(), 20);
  }
  ASSERT_TRUE(keep_freed_memory());
  (void)faults_of_large_array();
  EXPECT_LT(faults_of_large_array(), 10);
}

#endif

}  // namespace
}  // namespace resight
