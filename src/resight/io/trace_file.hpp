// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <filesystem>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "resight/core/input_file.hpp"
#include "resight/core/result.hpp"
#include "resight/geometry/rigid3.hpp"

namespace resight {

// What `resight recognize --trace` has written (docs/formats.md), read back. NaN: unknown.

/// Name of the file in the folder of the results.
inline constexpr const char* kTraceFile = "trace.jsonl";

/// The test that a hypothesis failed.
struct StoredFailedTest {
  std::string quantity;
  double value = 0;
  double limit = 0;
};

/// What one view of the window says of a hypothesis.
struct StoredHypothesisView {
  int view = 0;
  double visible_share = 0;
  double explained_share = 0;
};

/// What the verification found.
struct StoredVerification {
  Rigid3 world_from_object;  ///< Refined.
  std::optional<StoredFailedTest> failed_test;
  int suppressed_by = -1;  ///< Index into the hypotheses of the view; -1: none that is listed.
  double score = 0;        ///< 0 if it was rejected before.
  double fit = 0;
  double visible_share = 0;
  double explained_share = 0;
  double pattern_similarity = 0;
  double newest_similarity = 0;
  double shared_texture = 0;
  double texture_contrast = 0;
  double explained_scene = 0;  ///< The gain; the next three are costs.
  double outlier = 0;
  double clutter = 0;
  double plane = 0;
  std::vector<StoredHypothesisView> views;
};

/// A hypothesis after clustering.
struct StoredHypothesis {
  std::string object;
  std::string verdict;  ///< accepted, held back, not verified, or why it was rejected.
  std::vector<int> origin_views;
  int num_correspondences = 0;
  Rigid3 start;  ///< world_from_object before refinement.
  std::optional<StoredVerification> verification;
};

/// A true object that was not found.
struct StoredLoss {
  std::string object;
  Rigid3 world_from_object;
  double visible_share = 0;
  std::string stage;
  int num_keypoints = 0;
  int num_correspondences = 0;
  int num_right_correspondences = 0;
  double center_error_m = 0;  ///< Of the best hypothesis at this stage.
  double rotation_error_rad = 0;
  int hypothesis = -1;  ///< Index into the hypotheses of the view; -1: none.
};

struct StoredTrace {
  bool is_searched = true;
  int num_generated = 0;
  int num_merged = 0;
  int num_clustered = 0;
  std::vector<StoredHypothesis> hypotheses;  ///< At most kMaxTracedHypotheses, the most important ones first.
  std::vector<StoredLoss> lost;
};

/// trace.jsonl of a folder of results. Views are read when they are asked for.
class TraceFile {
 public:
  /// Fails if the file is no trace. `num_views`: of the results that it belongs to.
  [[nodiscard]] static Result<TraceFile> open(const std::filesystem::path& file, int num_views);
  /// A trace that is still being written. It has no views before find_new_views().
  [[nodiscard]] static TraceFile follow(std::filesystem::path file);
  /// Finds the views whose lines have been written since the last call. Fails if the file is no trace.
  [[nodiscard]] Result<void> find_new_views();
  [[nodiscard]] int num_views() const { return static_cast<int>(lines_.size()); }
  /// The trace of a view of the results. Fails if its line is missing or damaged, or is that of another view.
  [[nodiscard]] Result<StoredTrace> read(int view, const std::string& name) const;

 private:
  struct Line {
    std::uint64_t offset = 0;
    std::uint64_t size = 0;
  };
  [[nodiscard]] Result<std::string> read_line(const Line& line) const;
  [[nodiscard]] Result<void> check_header(const Line& line) const;
  std::filesystem::path file_;
  int max_views_ = std::numeric_limits<int>::max();  ///< Of the results; not known while they are written.
  /// Stays open: the file may be renamed once it is complete. Null: not found yet.
  std::shared_ptr<InputFile> content_;
  std::vector<Line> lines_;       ///< One per view.
  std::uint64_t end_offset_ = 0;  ///< Of the last whole line, its line break included; 0: the header is not read yet.
};

}  // namespace resight
