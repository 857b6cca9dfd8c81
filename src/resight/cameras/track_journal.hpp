// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "resight/cameras/view_tracker.hpp"
#include "resight/core/result.hpp"

namespace resight {

/// What a ViewTracker has found of each view so far, in a file: work that was interrupted goes on from there
/// (ViewTracker::restore_view()) and ends with the same bytes. JSON lines: what the job is, then a line a view.
class TrackJournal {
 public:
  /// Goes on with the journal in `file`, or begins one with the first step. `job` tells what is tracked: the steps of
  /// another job do not count, nor does a line that was not written to its end, nor those after it.
  TrackJournal(std::filesystem::path file, std::string job);

  /// Of views 0, 1, .. in order, as found in the file.
  [[nodiscard]] const std::vector<TrackerStep>& steps() const { return steps_; }
  /// An error if the file cannot be written.
  [[nodiscard]] Result<void> append(const TrackerStep& step);
  /// Removes the file: the work is done.
  void remove();

 private:
  [[nodiscard]] Result<void> begin();

  std::filesystem::path file_;
  std::string job_;
  std::vector<TrackerStep> steps_;
  std::ofstream out_;
};

}  // namespace resight
