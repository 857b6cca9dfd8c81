// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <fstream>
#include <string>
#include <utility>
#include <vector>

#include "resight/cameras/view_tracker.hpp"
#include "resight/core/result.hpp"

namespace resight {

/// File with the results of a ViewTracker for each view so far. An interrupted run resumes from it
/// (ViewTracker::restore_view()) and ends with the same bytes. JSON lines: a header with the job, then one line per
/// view.
class TrackJournal {
 public:
  /// Resumes the journal in `file`, or starts a new one with the first step. `job` identifies what is tracked: steps of
  /// another job are ignored, as is an incomplete line and everything after it. Fails if `file` is no journal, so that
  /// it is neither overwritten nor removed.
  [[nodiscard]] static Result<TrackJournal> open(std::filesystem::path file, std::string job);

  /// Steps of views 0, 1, ..., as found in the file.
  [[nodiscard]] const std::vector<TrackerStep>& steps() const { return steps_; }
  /// Appends a step. Fails if the file cannot be written.
  [[nodiscard]] Result<void> append(const TrackerStep& step);
  /// Removes the file after the job is done.
  void remove();

 private:
  TrackJournal(std::filesystem::path file, std::string job, std::vector<TrackerStep> steps)
      : file_(std::move(file)), job_(std::move(job)), steps_(std::move(steps)) {}
  [[nodiscard]] Result<void> begin();

  std::filesystem::path file_;
  std::string job_;
  std::vector<TrackerStep> steps_;
  std::ofstream out_;
};

}  // namespace resight
