// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <string>

#include "resight/core/result.hpp"
#include "resight/report/view_record.hpp"

namespace resight {

/// Detections as a BOP results file: scene_id,im_id,obj_id,score,R,t,time. R is camera_from_object row by row, t in
/// millimetres, time the wall seconds of the whole view (the same in each of its rows). The numbers read back to the
/// same doubles.
[[nodiscard]] std::string format_detections_csv(const ReportRun& run, const ModelLibrary& library);

/// The same with all that is known: per view its pose, and per detection object, track, score, visible share, poses in
/// camera and world, and the evidence of each view. Metres; rotations row by row; what is unknown is null.
[[nodiscard]] std::string format_detections_json(const ReportRun& run, const ModelLibrary& library);

/// What happened to the objects: one entry per event, and per view how much of its surface changed.
[[nodiscard]] std::string format_changes_json(const ReportRun& run, const ModelLibrary& library);

/// Settings, versions, counts, scores where there is ground truth, time per stage, peak memory.
[[nodiscard]] std::string format_summary_json(const ReportRun& run);

/// Writes detections.csv, detections.json, changes.json and summary.json into `directory`, which is made if it is
/// missing. Each file appears under its name only when it is whole; an older one is replaced.
[[nodiscard]] Result<void> write_results(const std::filesystem::path& directory, const ReportRun& run,
                                         const ModelLibrary& library);

}  // namespace resight
