// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "resight/core/result.hpp"
#include "resight/geometry/rigid3.hpp"
#include "resight/io/trace_file.hpp"

namespace resight {

// What `resight recognize` has written (docs/formats.md), read back. NaN: unknown.

/// Evidence of one view of the window for a detection.
struct StoredEvidence {
  int view = 0;
  bool allowed = true;
  double visible_share = 0;
  double explained_share = 0;
  double color_share = 0;
};

struct StoredDetection {
  std::string object;
  int bop_id = 0;
  int track = -1;
  double score = 0;
  double fit = 0;
  double visible_share = 0;
  Rigid3 world_from_object;
  /// Covariance of rotation (rad) and translation (m), 6x6, row by row.
  std::optional<std::array<double, 36>> covariance;
  std::vector<StoredEvidence> evidence;
  std::string verdict;  ///< With ground truth: correct, false, ghost or not counted. Empty: unknown.
};

struct StoredView {
  std::string name;
  Rigid3 world_from_camera;  ///< Corrected, if it was.
  std::vector<StoredDetection> detections;
  int num_novel_points = 0;
  int num_removed_points = 0;
  double changed_share = 0;
  bool pose_suspect = false;
};

struct StoredEvent {
  int view = 0;
  std::string kind;  ///< found, added, moved, removed, still_there or not_seen.
  std::string object;
  int track = -1;
  std::optional<Rigid3> world_from_object_before;
  std::optional<Rigid3> world_from_object_after;
  double confidence = 0;
};

struct RecognitionResults {
  std::string version;
  std::string preset;
  std::vector<StoredView> views;    ///< Views are numbered in this order.
  std::vector<StoredEvent> events;  ///< In the order of their views.
  /// Inputs of the run as summary.json names them: paths, below the results if they are relative. Empty: unknown.
  std::filesystem::path sequence;
  std::filesystem::path models;
  /// Options of the command line with which the sequence was opened: name and value in turn. Files as `sequence`.
  std::vector<std::string> sequence_options;
  std::optional<TraceFile> trace;  ///< With `--trace`.
};

/// Whether the value of an option of RecognitionResults::sequence_options may be the name of a file.
[[nodiscard]] bool may_name_file(std::string_view option, std::string_view value);

/// Whether the folder holds results of `resight recognize`.
[[nodiscard]] bool has_recognition_results(const std::filesystem::path& folder);

/// Reads detections.json and changes.json of a folder and, where they exist, summary.json and trace.jsonl (the latter
/// view by view, when it is asked for). Fails for files that do not agree, numbers that are not finite, poses that are
/// not rigid, names that check_object_name() refuses, and a folder that is not finished (check_finished()).
[[nodiscard]] Result<RecognitionResults> read_recognition_results(const std::filesystem::path& folder);

}  // namespace resight
