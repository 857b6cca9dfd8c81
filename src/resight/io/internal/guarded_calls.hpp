// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <csetjmp>
#include <string>
#include <utility>

#include "resight/core/result.hpp"

namespace resight::io {

/// Runs calls of a C library that reports errors to a callback which must not return. The callback sets the fault and
/// leaves by longjmp(). Then no destructor runs, so neither `calls` nor the callback may hold an object that needs one.
class GuardedCalls {
 public:
  template <typename Calls>
  [[nodiscard]] Result<void> run(const Calls& calls) {
    if (setjmp(start_) != 0) return Error{fault_};
    calls();
    return {};
  }
  void set_fault(std::string fault) { fault_ = std::move(fault); }
  [[noreturn]] void leave() { std::longjmp(start_, 1); }

 private:
  std::jmp_buf start_;
  std::string fault_;
};

}  // namespace resight::io
