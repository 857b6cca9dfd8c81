// SPDX-License-Identifier: Apache-2.0
#include "resight/viewer/internal/annotation_state_json.hpp"

#include "resight/annotation/annotated_events.hpp"
#include "resight/annotation/annotation_checks.hpp"
#include "resight/annotation/annotation_json.hpp"
#include "resight/annotation/matched_regions.hpp"
#include "resight/report/outline.hpp"
#include "resight/viewer/internal/view_json.hpp"

namespace resight::viewer {
namespace {

using annotation::to_text;

const char* name_of(AnnotationToDo::Kind kind) {
  switch (kind) {
    case AnnotationToDo::Kind::kTwoPlaces:
      return "two_places";
    case AnnotationToDo::Kind::kGap:
      return "gap";
    case AnnotationToDo::Kind::kSamePlace:
      return "same_place";
    case AnnotationToDo::Kind::kLostRegion:
      return "lost_region";
    case AnnotationToDo::Kind::kUnexplained:
      break;
  }
  return "unexplained";
}

Json objects_json(const AnnotationDocument& document) {
  Json objects = Json::array();
  for (const auto& [id, o] : document.objects)
    objects.push_back({{"id", id},
                       {"track", o.track},
                       {"object", o.object},
                       {"first_view", o.first_view},
                       {"last_view", o.last_view},
                       {"pose", matrix_json(o.world_from_object)}});
  return objects;
}

Json regions_json(const AnnotationDocument& document, const ModelLibrary& library,
                  std::span<const ChangeProposal> regions) {
  Json list = Json::array();
  const MatchedRegions matched = match_regions(document, regions);
  for (std::size_t r = 0; r < regions.size(); ++r) {
    const RegionJudgement* judged = matched.of_proposal[r];
    const bool is_judged = judged != nullptr;
    const ChangeProposal& region = regions[r];
    list.push_back({{"key", annotation::region_to_json(is_judged ? judged->region : region.key())},
                    {"view", region.view},
                    {"kind", to_string(region.kind)},
                    {"num_points", region.num_points},
                    {"pose", matrix_json(region.box.world_from_box)},
                    {"size_m", {region.box.size_m.x(), region.box.size_m.y(), region.box.size_m.z()}},
                    {"verdict", to_text(is_judged ? judged->verdict : RegionVerdict::kOpen)},
                    {"track", is_judged ? judged->track : -1},
                    {"is_corrected", is_judged && judged->mask},
                    {"is_explained", is_region_explained(document, library, region)}});
  }
  return list;
}

Json events_json(const AnnotationDocument& document, const ModelLibrary& library, int num_views) {
  Json events = Json::array();
  for (const AnnotatedEvent& e : derive_events(document, library, num_views))
    events.push_back({{"view", e.view},
                      {"kind", to_text(e.kind)},
                      {"track", e.track},
                      {"object", e.object},
                      {"name", e.name},
                      {"before", matrix_json(e.world_from_object_before)},
                      {"after", matrix_json(e.world_from_object_after)}});
  return events;
}

Json unknown_events_json(const AnnotationDocument& document) {
  Json events = Json::array();
  for (const auto& [id, e] : document.unknown_events)
    events.push_back({{"id", id},
                      {"view", e.view},
                      {"kind", to_text(e.kind)},
                      {"name", e.name},
                      {"before", annotation::point_to_json(e.before_in_world_m)},
                      {"after", annotation::point_to_json(e.after_in_world_m)}});
  return events;
}

Json to_dos_json(const AnnotationDocument& document, const ModelLibrary& library,
                 std::span<const ChangeProposal> regions) {
  Json list = Json::array();
  for (const AnnotationToDo& to_do : find_to_dos(document, library, regions))
    list.push_back({{"kind", name_of(to_do.kind)},
                    {"view", to_do.view},
                    {"track", to_do.track},
                    {"region", to_do.region},
                    {"text", to_do.text},
                    {"lost", to_do.lost ? Json(annotation::region_to_json(*to_do.lost)) : Json(nullptr)}});
  return list;
}

}  // namespace

std::string format_annotation(const AnnotationProject& project, const ModelLibrary& library,
                              std::span<const ChangeProposal> regions) {
  const AnnotationDocument& document = project.document();
  return to_text({{"revision", project.revision()},
                  {"undo", project.undo_title()},
                  {"redo", project.redo_title()},
                  {"objects", objects_json(document)},
                  {"checked_views", std::vector<int>(document.checked_views.begin(), document.checked_views.end())},
                  {"regions", regions_json(document, library, regions)},
                  {"events", events_json(document, library, project.limits().num_views)},
                  {"unknown_events", unknown_events_json(document)},
                  {"to_dos", to_dos_json(document, library, regions)}});
}

std::string format_annotated_view(const AnnotationDocument& document, const ModelLibrary& library,
                                  const RgbdFrame& frame, int view) {
  Json json = {{"camera", camera_json(frame.camera)}, {"detections", Json::array()}, {"truth", Json::array()}};
  for (const auto& [id, object] : document.objects) {
    if (!object.is_in(view)) continue;
    const ObjectModel& model = library.objects[static_cast<std::size_t>(object.object)];
    const auto outline = find_outline(frame.camera, frame.world_from_camera.inverse() * object.world_from_object,
                                      model.surface, static_cast<double>(library.surface_voxel_m));
    json["detections"].push_back(
        {{"id", id}, {"evidence", Json::array()}, {"covariance", nullptr}, {"outline", contours_json(outline)}});
  }
  return to_text(json);
}

Json residuals_json(const std::vector<ViewResidual>& residuals) {
  Json views = Json::array();
  for (const ViewResidual& r : residuals)
    views.push_back({{"view", r.view},
                     {"num_visible", r.num_visible},
                     {"supported_share", r.supported_share},
                     {"median_mm", 1000 * r.median_distance_m},
                     {"is_informative", r.is_informative},
                     {"is_gone", r.is_gone},
                     {"is_used", r.is_used}});
  return views;
}

}  // namespace resight::viewer
