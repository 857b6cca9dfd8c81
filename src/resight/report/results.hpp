// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <string>

#include "resight/core/result.hpp"
#include "resight/report/view_record.hpp"

namespace resight {

/// Formats detections as a BOP results file: scene_id,im_id,obj_id,score,R,t,time. R is camera_from_object row by row,
/// t is in millimetres, time is the wall time of the whole view in seconds (equal in all its rows). Numbers are written
/// without loss.
[[nodiscard]] std::string format_detections_csv(const ReportRun& run, const ModelLibrary& library);

/// Formats detections as JSON (docs/formats.md): pose of each view; object, track, score, visible share, poses in
/// camera and world, and evidence per view of each detection. Metres; rotations row by row; unknown values are null.
[[nodiscard]] std::string format_detections_json(const ReportRun& run, const ModelLibrary& library);

/// Formats one view as one line of JSON, without a line break: what format_detections_json() holds of it, and "events",
/// those of format_changes_json() that were reported at this view. Later views may still supersede an event.
[[nodiscard]] std::string format_view_line(const ViewRecord& view, const ModelLibrary& library);

/// Formats the changes as JSON: one entry per event, and the changed share per view.
[[nodiscard]] std::string format_changes_json(const ReportRun& run, const ModelLibrary& library);

/// Formats the summary as JSON: settings, versions, counts, scores if there is ground truth, time per stage, peak
/// memory.
[[nodiscard]] std::string format_summary_json(const ReportRun& run);

/// Writes detections.csv, detections.json, changes.json and summary.json to `directory`, which is created if necessary.
/// Each file appears under its name only when it is complete, replacing an older one.
[[nodiscard]] Result<void> write_results(const std::filesystem::path& directory, const ReportRun& run,
                                         const ModelLibrary& library);

}  // namespace resight
