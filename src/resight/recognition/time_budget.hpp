// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "resight/core/deadline.hpp"
#include "resight/hypotheses/hypothesis.hpp"

namespace resight {

/// Divides the time of a view between search and verification, by the pace of the last verification.
class TimeBudget {
 public:
  using IsTracked = std::function<bool(const Hypothesis&)>;

  /// `deadline_ms` from start_view() on.
  TimeBudget(std::optional<double> deadline_ms, Clock clock) : deadline_ms_(deadline_ms), clock_(std::move(clock)) {}

  void start_view();
  /// The deadline of the search: it leaves the time that the last verification took.
  [[nodiscard]] Deadline search_deadline() const { return deadline_.earlier_by(verification_s_); }
  /// Keeps the hypotheses that can be verified in time, but at least 10 and all tracked ones: first the tracked ones,
  /// then those with the most correspondences. The pool keeps the rest as long as their view is in the window; without
  /// earlier views in it, the next view searches for them anew. Describes what was dropped in `left_out`.
  void drop_late(std::vector<Hypothesis>& hypotheses, const IsTracked& is_tracked,
                 std::vector<std::string>& left_out) const;
  void start_verification() { verification_start_s_ = clock_(); }
  void finish_verification(std::size_t num_hypotheses);

 private:
  std::optional<double> deadline_ms_;
  Clock clock_;
  Deadline deadline_;  // Of this view.
  double verification_start_s_ = 0;
  double verification_s_ = 0;       // Of the last view.
  double s_per_hypothesis_ = 1e-9;  // Likewise; at first, next to nothing.
};

}  // namespace resight
