// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <fstream>
#include <string>
#include <utility>

namespace resight::app {

/// What `recognize` has finished, for a run that is interrupted or fails: `finished_views.jsonl` in the folder of the
/// results, a line per view. The complete results take its place.
class FinishedViews {
 public:
  explicit FinishedViews(const std::filesystem::path& folder) : file_(folder / "finished_views.jsonl") {}

  /// Appends a line. The first one replaces the file of a run before. Throws an InputError if it cannot be written.
  void add(const std::string& line);
  void remove();

 private:
  std::filesystem::path file_;
  std::ofstream out_;
};

}  // namespace resight::app
