// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <functional>
#include <limits>
#include <utility>

namespace resight {

/// Returns seconds since an arbitrary fixed moment.
using Clock = std::function<double()>;
/// The monotonic clock of the system, in seconds.
[[nodiscard]] double steady_clock_s();

/// The moment at which an answer is due.
class Deadline {
 public:
  Deadline() = default;  ///< Never due.
  Deadline(double seconds_from_now, Clock clock) : clock_(std::move(clock)), due_s_(clock_() + seconds_from_now) {}

  /// Seconds until the deadline; negative if it has passed, infinite if there is none.
  [[nodiscard]] double left_s() const { return clock_ ? due_s_ - clock_() : std::numeric_limits<double>::infinity(); }
  [[nodiscard]] bool has_passed() const { return left_s() <= 0; }
  /// The same deadline, due `seconds` earlier.
  [[nodiscard]] Deadline earlier_by(double seconds) const {
    Deadline earlier = *this;
    earlier.due_s_ -= seconds;
    return earlier;
  }

 private:
  Clock clock_;
  double due_s_ = 0;
};

}  // namespace resight
