// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <iterator>
#include <map>
#include <numbers>

#include "resight/models/pose_distance.hpp"
#include "resight/report/internal/html.hpp"

namespace resight::report {
namespace {

std::string position_text(const Rigid3& pose) {
  const Eigen::Vector3d& t = pose.translation;
  return fmt::format("{:.3f} {:.3f} {:.3f}", t.x(), t.y(), t.z());
}

/// Rotation vector in degrees: rotation axis times angle.
std::string rotation_text(const Rigid3& pose) {
  const Eigen::AngleAxisd turn(pose.rotation);
  const Eigen::Vector3d degrees = turn.axis() * (turn.angle() * 180 / std::numbers::pi);
  return fmt::format("{:.1f} {:.1f} {:.1f}", degrees.x(), degrees.y(), degrees.z());
}

std::string verdict_cell(DetectionMark mark) {
  const char* css_class = mark == DetectionMark::kCorrect                                          ? "good"
                          : mark == DetectionMark::kFalsePositive || mark == DetectionMark::kGhost ? "bad"
                                                                                                   : "soft";
  return fmt::format("<td class=\"{}\">{}</td>", css_class, to_string(mark));
}

std::string detections_table(const ViewRecord& view, const ModelLibrary& library) {
  if (view.update.detections.empty()) return "<p class=\"soft\">No objects recognised.</p>\n";
  const bool judged = view.evaluation.has_value();
  std::string html = "<table><thead><tr><th>Object</th>";
  if (judged) html += "<th>Verdict</th>";
  html +=
      "<th class=\"n\">Track</th><th class=\"n\">Score</th><th class=\"n\">Visible</th>"
      "<th>Position in world, m</th><th title=\"Rotation vector: axis times angle\">Rotation, "
      "°</th></tr></thead><tbody>\n";
  for (std::size_t i = 0; i < view.update.detections.size(); ++i) {
    const Detection& detection = view.update.detections[i];
    fmt::format_to(std::back_inserter(html),
                   "<tr><td>{}</td>{}<td class=\"n\">{}</td><td class=\"n\">{}</td><td class=\"n\">{}</td>"
                   "<td>{}</td><td>{}</td></tr>\n",
                   object_tag(detection.object, library), judged ? verdict_cell(view.marks.at(i)) : std::string(),
                   detection.track < 0 ? std::string("–") : fmt::format("#{}", detection.track),
                   number(detection.score, 2), percent(detection.visible_share),
                   position_text(detection.world_from_object), rotation_text(detection.world_from_object));
  }
  return html + "</tbody></table>\n";
}

std::string event_text(const ObjectEvent& event, const ModelLibrary& library) {
  const std::string kind = to_string(event.kind);
  std::string html = fmt::format("<li><span class=\"tag {0}\">{0}</span>{1} <span class=\"soft\">#{2}</span>", kind,
                                 object_tag(event.object, library), event.track);
  if (event.kind == ObjectEventKind::kMoved && event.world_from_object_before && event.world_from_object_after) {
    const ObjectModel& model = library.objects[static_cast<std::size_t>(event.object)];
    const PoseDifference move = compare_poses(*event.world_from_object_after, *event.world_from_object_before, model);
    html += fmt::format(" by {:.1f} cm", 100 * move.center_distance_m);
  }
  return html + fmt::format(" <span class=\"soft\">confidence {}</span></li>\n", number(event.confidence, 2));
}

std::string events_list(const std::vector<ObjectEvent>& events, const ModelLibrary& library) {
  std::string items;
  for (const ObjectEvent& event : events) {
    if (is_change(event.kind) || event.kind == ObjectEventKind::kFound) items += event_text(event, library);
  }
  return items.empty() ? "" : "<ul class=\"events\">\n" + items + "</ul>\n";
}

std::string missed_line(const ViewRecord& view) {
  if (!view.evaluation || view.evaluation->missed.empty()) return "";
  std::string names;
  for (const GroundTruthObject& missed : view.evaluation->missed) {
    names += (names.empty() ? "" : ", ") + escape(missed.object);
  }
  return "<p class=\"soft\">Missed: " + names + "</p>\n";
}

std::string details(const ViewRecord& view) {
  const HypothesisCounts& counts = view.update.counts;
  std::string html = fmt::format(
      "<details><summary>{} in {} stages; {} hypotheses after clustering</summary>"
      "<p>Correspondences {} · hypotheses of this view {} · with those of earlier views {} · after clustering {} · "
      "accepted {}<br>Scene points {} · novel {} · removed {} · changed share of the visible surface {}{}</p>"
      "<table><thead><tr><th>Stage</th><th class=\"n\">Wall</th><th class=\"n\">CPU</th></tr></thead><tbody>\n",
      duration(view.update.times.total_wall_s()), view.update.times.stages().size(), counts.clustered,
      counts.correspondences, counts.generated, counts.merged, counts.clustered, counts.accepted,
      view.update.reconstruction_points, view.num_novel_points, view.num_removed_points,
      percent(view.update.changes.changed_share),
      view.update.changes.pose_suspect ? " · <b>camera pose suspect: changes of this view ignored</b>" : "");
  for (const StageTime& time : view.update.times.stages()) {
    html += fmt::format("<tr><td>{}</td><td class=\"n\">{}</td><td class=\"n\">{}</td></tr>\n", escape(time.stage),
                        duration(time.wall_s), duration(time.cpu_s));
  }
  return html + "</tbody></table></details>\n";
}

std::string picture(const ReportRun& run, const ViewRecord& view) {
  if (view.picture_file.empty() && view.picture_jpeg.empty()) return "";
  const std::string source =
      view.picture_file.empty() ? "data:image/jpeg;base64," + base64(view.picture_jpeg) : view.picture_file;
  return fmt::format("<img loading=\"lazy\" alt=\"View {}, {}: recognised objects\" src=\"{}\">\n", view.update.view,
                     escape(run.preset), source);
}

std::string view_column(const ReportRun& run, const ViewRecord& view, const ModelLibrary& library, bool name_run) {
  std::string html = "<div>";
  if (name_run) html += "<h3>" + escape(run.preset) + "</h3>\n";
  html += picture(run, view);
  return html + events_list(view.update.events, library) + detections_table(view, library) + missed_line(view) +
         details(view) + "</div>\n";
}

std::string picture_legend() {
  return "<p class=\"soft\">Solid outline: recognised. Dashed: false positive (crossed out: a ghost, at a place the "
         "object has left). Dotted white: missed. <span class=\"patch\" style=\"background:#1ec83c\"></span>novel "
         "surface, <span class=\"patch\" style=\"background:#eb1e28\"></span>removed surface.</p>\n";
}

}  // namespace

ViewRange range_of(std::span<const ReportRun> runs) {
  ViewRange range;
  for (const ReportRun& run : runs)
    for (const ViewRecord& view : run.views) range.end = std::max(range.end, view.update.view + 1);
  return range;
}

std::string views_section(std::span<const ReportRun> runs, const ModelLibrary& library, const ViewRange& range) {
  std::map<int, std::vector<std::pair<const ReportRun*, const ViewRecord*>>> by_view;
  for (const ReportRun& run : runs) {
    for (const ViewRecord& view : run.views)
      if (range.contains(view.update.view)) by_view[view.update.view].emplace_back(&run, &view);
  }
  if (by_view.empty()) return "";
  std::string html = "<h2 id=\"views\">Views</h2>\n" + picture_legend();
  for (const auto& [number_of_view, columns] : by_view) {
    html += fmt::format(
        "<article id=\"view-{0}\"><h3>View {0} <span class=\"soft\">{1}</span></h3>\n<div class=\"runs\">\n",
        number_of_view, escape(columns.front().second->update.view_name));
    for (const auto& [run, view] : columns) html += view_column(*run, *view, library, runs.size() > 1);
    html += "</div></article>\n";
  }
  return html;
}

}  // namespace resight::report
