// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <utility>
#include <vector>

#include "resight/core/json_text.hpp"
#include "resight/core/statistics.hpp"
#include "resight/report/internal/json_values.hpp"
#include "resight/report/internal/results_text.hpp"
#include "resight/report/results.hpp"

namespace resight {
namespace {

using report::pose_json;
using report::score_json;
using report::to_text;
using Json = nlohmann::ordered_json;

Json optional_pose_json(const std::optional<Rigid3>& pose) { return pose ? pose_json(*pose) : Json(nullptr); }

// Numbers row by row; null if unknown.
Json uncertainty_json(const PoseUncertainty& uncertainty) {
  if (!uncertainty.is_known()) return nullptr;
  const auto& c = uncertainty.covariance;
  const auto std_of = [&](int i) { return std::sqrt(c(i, i)); };
  Json free = Json::array();
  for (const auto& d : uncertainty.free_directions) free.push_back(std::vector<double>(d.begin(), d.end()));
  std::vector<double> rows;
  for (int i = 0; i < 6; ++i)
    for (int k = 0; k < 6; ++k) rows.push_back(c(i, k));
  return {{"rotation_std_rad", {std_of(0), std_of(1), std_of(2)}},
          {"translation_std_m", {std_of(3), std_of(4), std_of(5)}},
          {"covariance", rows},
          {"free_directions", free}};
}

Json detection_json(const ViewRecord& view, std::size_t index, const ModelLibrary& library) {
  const Detection& detection = view.update.detections[index];
  const ObjectModel& model = library.object(detection.object);
  Json evidence = Json::array();
  for (const DetectionViewEvidence& e : detection.views) {
    evidence.push_back({{"view", e.view},
                        {"allowed", e.allowed},
                        {"visible_share", e.visible_share},
                        {"explained_share", e.explained_share},
                        {"color_share", e.color_share}});
  }
  Json json = {{"object", model.name},
               {"obj_id", model.bop_id},
               {"track", detection.track},
               {"score", detection.score},
               {"fit", detection.fit},
               {"visible_share", detection.visible_share},
               {"camera_from_object", pose_json(view.update.world_from_camera.inverse() * detection.world_from_object)},
               {"world_from_object", pose_json(detection.world_from_object)},
               {"uncertainty", uncertainty_json(detection.uncertainty)},
               {"evidence", evidence}};
  if (view.evaluation) json["verdict"] = to_string(view.marks.at(index));
  return json;
}

Json event_json(const ObjectEvent& event, const ModelLibrary& library) {
  return {{"view", event.view},
          {"kind", to_string(event.kind)},
          {"object", library.object(event.object).name},
          {"track", event.track},
          {"world_from_object_before", optional_pose_json(event.world_from_object_before)},
          {"world_from_object_after", optional_pose_json(event.world_from_object_after)},
          {"confidence", event.confidence}};
}

Json view_json(const ViewRecord& view, const ModelLibrary& library) {
  Json detections = Json::array();
  for (std::size_t i = 0; i < view.update.detections.size(); ++i)
    detections.push_back(detection_json(view, i, library));
  Json of_view = {{"view", view.update.view},
                  {"name", view.update.view_name},
                  {"scene_id", view.scene_id},
                  {"image_id", view.image_id},
                  {"world_from_camera", pose_json(view.update.world_from_camera)},
                  {"detections", detections}};
  if (!view.update.left_out.empty()) of_view["left_out"] = view.update.left_out;
  return of_view;
}

Json stage_times_json(const StageTimes& times, int num_views) {
  Json json = Json::array();
  for (const StageTime& time : times.stages()) {
    json.push_back({{"stage", time.stage},
                    {"wall_s", time.wall_s},
                    {"cpu_s", time.cpu_s},
                    {"wall_s_per_view", time.wall_s / std::max(1, num_views)}});
  }
  return json;
}

// Null if no view showed it.
Json color_offset_json(const ReportRun& run) {
  if (run.views.empty() || !std::isfinite(run.views.back().update.camera_errors.color_offset.sigma_px.maxCoeff()))
    return nullptr;
  const ColorOffset& offset = run.views.back().update.camera_errors.color_offset;
  return {{"offset_px", {offset.offset_px.x(), offset.offset_px.y()}},
          {"sigma_px", {offset.sigma_px.x(), offset.sigma_px.y()}},
          {"num_views", offset.num_views},
          {"corrected_px", {offset.corrected_px().x(), offset.corrected_px().y()}}};
}

// Null if it was not measured.
Json depth_bias_json(const ReportRun& run) {
  if (run.views.empty() || run.views.back().update.camera_errors.depth_bias.num_views < 2) return nullptr;
  const DepthBias& bias = run.views.back().update.camera_errors.depth_bias;
  return {{"per_m", bias.per_m},
          {"sigma_per_m", bias.sigma_per_m},
          {"num_views", bias.num_views},
          {"corrected", bias.is_significant()}};
}

// Null if no view could be compared with earlier ones.
Json pose_correction_json(const ReportRun& run) {
  std::vector<double> moved_m, moved_rad, sigmas_m, sigmas_rad;
  int num_corrected = 0;
  for (const ViewRecord& view : run.views) {
    const PoseCorrection& correction = view.update.pose_correction;
    if (!correction.is_measured) continue;
    moved_m.push_back(correction.moved_m);
    moved_rad.push_back(correction.moved_rad);
    sigmas_m.push_back(correction.sigma_m);
    sigmas_rad.push_back(correction.sigma_rad);
    num_corrected += correction.moved_m > 0 || correction.moved_rad > 0 ? 1 : 0;
  }
  if (moved_m.empty()) return nullptr;
  return {{"num_views", moved_m.size()},
          {"num_corrected", num_corrected},
          {"largest_m", std::ranges::max(moved_m)},
          {"largest_rad", std::ranges::max(moved_rad)},
          {"median_m", upper_median(std::move(moved_m))},
          {"median_rad", upper_median(std::move(moved_rad))},
          {"sigma_m", upper_median(std::move(sigmas_m))},
          {"sigma_rad", upper_median(std::move(sigmas_rad))}};
}

Json unknown_if_empty(const std::string& text) { return text.empty() ? Json(nullptr) : Json(text); }

Json unknown_if_zero(std::size_t value) { return value == 0 ? Json(nullptr) : Json(value); }

Json header(const ReportRun& run) {
  return {{"version", run.version}, {"preset", run.preset}, {"sequence", run.sequence}};
}

}  // namespace

std::string format_view_line(const ViewRecord& view, const ModelLibrary& library) {
  Json json = view_json(view, library);
  json["events"] = Json::array();
  for (const ObjectEvent& event : view.update.events) json["events"].push_back(event_json(event, library));
  return to_json_text(json);
}

void report::put_detections_json(const ReportRun& run, const ModelLibrary& library, const TextSink& sink) {
  JsonLists lists(header(run), sink);
  lists.begin("views");
  for (const ViewRecord& view : run.views) lists.add(view_json(view, library));
  lists.end();
  lists.finish();
}

void report::put_changes_json(const ReportRun& run, const ModelLibrary& library, const TextSink& sink) {
  JsonLists lists(header(run), sink);
  lists.begin("events");
  for (const ViewRecord& view : run.views)
    for (const ObjectEvent& event : view.update.events) lists.add(event_json(event, library));
  lists.end();
  lists.begin("views");
  for (const ViewRecord& view : run.views)
    lists.add({{"view", view.update.view},
               {"name", view.update.view_name},
               {"novel_points", view.num_novel_points},
               {"removed_points", view.num_removed_points},
               {"changed_share", view.update.changes.changed_share},
               {"pose_suspect", view.update.changes.pose_suspect}});
  lists.end();
  lists.finish();
}

std::string format_summary_json(const ReportRun& run) {
  const RunSummary summary = summarize(run);
  Json settings = Json::object();
  for (const auto& [name, value] : run.settings) settings[name] = value;
  Json json = header(run);
  json["inputs"] = {{"sequence", unknown_if_empty(run.sequence_path)}, {"models", unknown_if_empty(run.models_path)}};
  if (!run.sequence_options.empty()) json["inputs"]["sequence_options"] = run.sequence_options;
  json["settings"] = settings;
  json["num_threads"] = unknown_if_zero(static_cast<std::size_t>(std::max(0, run.num_threads)));
  json["num_views"] = summary.num_views;
  json["num_detections"] = summary.num_detections;
  json["num_changes"] = summary.num_events;
  json["mean_view_wall_s"] = summary.mean_view_wall_s;
  json["median_view_wall_s"] = summary.median_view_wall_s;
  json["stages"] = stage_times_json(summary.times, summary.num_views);
  json["color_offset"] = color_offset_json(run);
  json["depth_bias"] = depth_bias_json(run);
  json["pose_correction"] = pose_correction_json(run);
  if (run.num_skipped_views) json["num_skipped_views"] = *run.num_skipped_views;
  json["peak_memory_bytes"] = unknown_if_zero(run.peak_memory_bytes);
  if (summary.num_scored_views > 0) {
    json["evaluation"] = {{"num_views", summary.num_scored_views},
                          {"score", score_json(summary.score)},
                          {"strict_score", score_json(summary.strict_score)},
                          {"num_ghosts", summary.num_ghosts}};
  }
  return to_text(json);
}

}  // namespace resight
