// SPDX-License-Identifier: Apache-2.0
#include "resight/viewer/internal/annotation_state_json.hpp"

#include <cmath>

#include "resight/annotation/annotated_events.hpp"
#include "resight/annotation/annotation_checks.hpp"
#include "resight/report/outline.hpp"

namespace resight::viewer {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kMaxPoseRepair = 0.01;

const char* name_of(RegionVerdict verdict) {
  if (verdict == RegionVerdict::kAccepted) return "accepted";
  return verdict == RegionVerdict::kRejected ? "rejected" : "open";
}
const char* name_of(AnnotatedEventKind kind) {
  if (kind == AnnotatedEventKind::kAdded) return "added";
  return kind == AnnotatedEventKind::kMoved ? "moved" : "removed";
}
const char* name_of(AnnotationToDo::Kind kind) {
  switch (kind) {
    case AnnotationToDo::Kind::kTwoPlaces:
      return "two_places";
    case AnnotationToDo::Kind::kGap:
      return "gap";
    case AnnotationToDo::Kind::kSamePlace:
      return "same_place";
    case AnnotationToDo::Kind::kUnexplained:
      break;
  }
  return "unexplained";
}

Json pose_or_null(const std::optional<Rigid3>& pose) { return pose ? pose_json(*pose) : Json(nullptr); }

Json objects_json(const AnnotationDocument& document) {
  Json objects = Json::array();
  for (const auto& [id, o] : document.objects)
    objects.push_back({{"id", id},
                       {"track", o.track},
                       {"object", o.object},
                       {"first_view", o.first_view},
                       {"last_view", o.last_view},
                       {"pose", pose_json(o.world_from_object)}});
  return objects;
}

Json regions_json(const AnnotationDocument& document, const ModelLibrary& library,
                  std::span<const ChangeProposal> regions) {
  Json list = Json::array();
  for (std::size_t r = 0; r < regions.size(); ++r) {
    const auto judged = document.regions.find(static_cast<int>(r));
    const bool is_judged = judged != document.regions.end();
    const ChangeProposal& region = regions[r];
    list.push_back({{"view", region.view},
                    {"kind", to_string(region.kind)},
                    {"num_points", region.num_points},
                    {"pose", pose_json(region.box.world_from_box)},
                    {"size_m", {region.box.size_m.x(), region.box.size_m.y(), region.box.size_m.z()}},
                    {"verdict", name_of(is_judged ? judged->second.verdict : RegionVerdict::kOpen)},
                    {"track", is_judged ? judged->second.track : -1},
                    {"is_explained", is_region_explained(document, library, region)}});
  }
  return list;
}

Json events_json(const AnnotationDocument& document, const ModelLibrary& library, int num_views) {
  Json events = Json::array();
  for (const AnnotatedEvent& e : derive_events(document, library, num_views))
    events.push_back({{"view", e.view},
                      {"kind", name_of(e.kind)},
                      {"track", e.track},
                      {"object", e.object},
                      {"name", e.name},
                      {"before", pose_or_null(e.world_from_object_before)},
                      {"after", pose_or_null(e.world_from_object_after)}});
  return events;
}

Json unknown_events_json(const AnnotationDocument& document) {
  const auto point = [](const std::optional<Eigen::Vector3d>& p) {
    return p ? Json{p->x(), p->y(), p->z()} : Json(nullptr);
  };
  Json events = Json::array();
  for (const auto& [id, e] : document.unknown_events)
    events.push_back({{"id", id},
                      {"view", e.view},
                      {"kind", name_of(e.kind)},
                      {"name", e.name},
                      {"before", point(e.before_in_world_m)},
                      {"after", point(e.after_in_world_m)}});
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
                    {"text", to_do.text}});
  return list;
}

Json contours_json(const std::vector<std::vector<Pixel>>& contours) {
  Json list = Json::array();
  for (const std::vector<Pixel>& contour : contours) {
    Json line = Json::array();
    for (const Pixel& pixel : contour) {
      line.push_back(pixel.u);
      line.push_back(pixel.v);
    }
    list.push_back(std::move(line));
  }
  return list;
}

std::string dump(const Json& json) { return json.dump(-1, ' ', false, Json::error_handler_t::replace); }

}  // namespace

Json pose_json(const Rigid3& pose) {
  const Eigen::Matrix4d matrix = pose.matrix();  // stored column by column
  return std::vector<double>(matrix.data(), matrix.data() + matrix.size());
}

std::optional<Rigid3> parse_pose_json(const nlohmann::json& json) {
  if (!json.is_array() || json.size() != 16) return std::nullopt;
  Eigen::Matrix4d matrix;
  for (Eigen::Index i = 0; i < 16; ++i) {
    const nlohmann::json& number = json[static_cast<std::size_t>(i)];
    if (!number.is_number()) return std::nullopt;
    matrix.data()[i] = number.get<double>();
  }
  Rigid3 pose = Rigid3::from_matrix(matrix);
  if (!matrix.allFinite() || !pose.is_rigid(kMaxPoseRepair)) return std::nullopt;
  pose.rotation = nearest_rotation(pose.rotation);
  return pose;
}

std::string format_annotation(const AnnotationProject& project, const ModelLibrary& library,
                              std::span<const ChangeProposal> regions) {
  const AnnotationDocument& document = project.document();
  return dump({{"revision", project.revision()},
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
  const Camera& camera = frame.camera;
  Json json = {{"camera",
                {{"width", camera.width},
                 {"height", camera.height},
                 {"fx", camera.fx},
                 {"fy", camera.fy},
                 {"cx", camera.cx},
                 {"cy", camera.cy}}},
               {"detections", Json::array()},
               {"truth", Json::array()}};
  for (const auto& [id, object] : document.objects) {
    if (!object.is_in(view)) continue;
    const ObjectModel& model = library.objects[static_cast<std::size_t>(object.object)];
    const auto outline = find_outline(camera, frame.world_from_camera.inverse() * object.world_from_object,
                                      model.surface, static_cast<double>(library.surface_voxel_m));
    json["detections"].push_back(
        {{"evidence", Json::array()}, {"covariance", nullptr}, {"outline", contours_json(outline)}});
  }
  return dump(json);
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
