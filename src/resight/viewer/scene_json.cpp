// SPDX-License-Identifier: Apache-2.0
#include "resight/viewer/internal/scene_json.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <optional>

#include "resight/models/pose_distance.hpp"
#include "resight/report/outline.hpp"
#include "resight/report/overlay.hpp"
#include "resight/viewer/internal/view_json.hpp"

namespace resight::viewer {
namespace {

Json object_json(const ViewerScene& scene, const ObjectTable::Object& object, int number) {
  const Rgb8 color = object_color(number);
  Json json = {{"name", object.name},
               {"obj_id", object.bop_id},
               {"color", fmt::format("#{:02x}{:02x}{:02x}", color.r, color.g, color.b)}};
  const auto index = static_cast<std::size_t>(number);
  json["has_surface"] = scene.library ? index < scene.library->objects.size() : index < scene.models.size();
  if (!scene.library || index >= scene.library->objects.size()) return json;
  const ObjectModel& model = scene.library->objects[index];
  json["center"] = {model.center.x(), model.center.y(), model.center.z()};
  json["diameter_m"] = model.diameter_m;
  json["num_points"] = model.surface.size();
  json["num_sift"] = model.sift.size();
  json["num_shot"] = model.shot.size();
  json["num_symmetries"] = model.symmetries.discrete.size() + model.symmetries.continuous.size();
  return json;
}

Json detection_json(const StoredDetection& detection, const ObjectTable& objects) {
  return {{"object", objects.find(detection.object)},
          {"track", detection.track},
          {"score", detection.score},
          {"fit", detection.fit},
          {"visible_share", detection.visible_share},
          {"verdict", detection.verdict},
          {"pose", matrix_json(detection.world_from_object)}};
}

Json stored_view_json(const StoredView& view, const ObjectTable& objects) {
  Json detections = Json::array();
  for (const StoredDetection& detection : view.detections) detections.push_back(detection_json(detection, objects));
  return {{"pose", matrix_json(view.world_from_camera)}, {"detections", detections},
          {"novel_points", view.num_novel_points},       {"removed_points", view.num_removed_points},
          {"changed_share", view.changed_share},         {"pose_suspect", view.pose_suspect}};
}

Json event_json(const StoredEvent& event, int view, const ObjectTable& objects) {
  return {{"view", view},
          {"kind", event.kind},
          {"object", objects.find(event.object)},
          {"track", event.track},
          {"before", matrix_json(event.world_from_object_before)},
          {"after", matrix_json(event.world_from_object_after)},
          {"confidence", event.confidence}};
}

Json run_json(const ViewerRun& run, const std::vector<int>& stored_views, const ObjectTable& objects) {
  Json views = Json::array();
  for (const int stored : stored_views)
    views.push_back(stored < 0 ? Json(nullptr)
                               : stored_view_json(run.results.views[static_cast<std::size_t>(stored)], objects));
  const SequenceNumbers numbers(stored_views);
  Json events = Json::array();
  for (const StoredEvent& event : run.results.events)
    events.push_back(event_json(event, numbers.of(event.view), objects));
  return {{"name", run.name},
          {"preset", run.results.preset},
          {"version", run.results.version},
          {"has_trace", run.results.trace.has_value()},
          {"views", views},
          {"events", events}};
}

Json views_json(const Sequence& sequence) {
  Json views = Json::array();
  for (int v = 0; v < sequence.num_views(); ++v) {
    const auto pose = sequence.read_pose(v);
    views.push_back({{"name", sequence.view_name(v)}, {"pose", pose.ok() ? matrix_json(*pose) : Json(nullptr)}});
  }
  return views;
}

/// The model of an object of the table; null if it has none.
const ObjectModel* find_model(const ViewerScene& scene, int object) {
  if (!scene.library || object < 0 || object >= static_cast<int>(scene.library->objects.size())) return nullptr;
  return &scene.library->objects[static_cast<std::size_t>(object)];
}

Json outline_json(const ViewerScene& scene, int object, const Camera& camera, const Rigid3& camera_from_object) {
  const ObjectModel* model = find_model(scene, object);
  if (model == nullptr) return Json::array();
  return contours_json(find_outline(camera, camera_from_object, model->surface, scene.library->surface_voxel_m));
}

/// How far a detection is from the nearest true pose of its object; null without one, or without a model, whose centre
/// and symmetries it takes.
Json truth_error_json(const StoredDetection& detection, const ObjectModel* model, const Rigid3& world_from_camera,
                      const std::vector<GroundTruthObject>& truth) {
  std::optional<PoseDifference> nearest;
  for (const GroundTruthObject& object : truth) {
    if (model == nullptr || object.object != detection.object) continue;
    const PoseDifference difference =
        compare_poses(detection.world_from_object, world_from_camera * object.camera_from_object, *model);
    if (!nearest || difference.center_distance_m < nearest->center_distance_m) nearest = difference;
  }
  if (!nearest) return nullptr;
  return {{"center_distance_m", nearest->center_distance_m}, {"rotation_rad", nearest->rotation_rad}};
}

Json details_json(const StoredDetection& detection, const SequenceNumbers& numbers) {
  Json evidence = Json::array();
  for (const StoredEvidence& e : detection.evidence)
    evidence.push_back({{"view", numbers.of(e.view)},
                        {"allowed", e.allowed},
                        {"visible_share", e.visible_share},
                        {"explained_share", e.explained_share},
                        {"color_share", e.color_share}});
  Json json = {{"evidence", evidence}, {"covariance", nullptr}};
  if (detection.covariance)
    json["covariance"] = std::vector<double>(detection.covariance->begin(), detection.covariance->end());
  return json;
}

}  // namespace

std::string format_index(const ViewerScene& scene, const ObjectTable& objects, const StoredViewNumbers& stored_views,
                         int revision) {
  Json json = {
      {"title", scene.title}, {"revision", revision}, {"is_live", scene.is_live}, {"is_annotated", scene.is_annotated}};
  json["views"] = scene.sequence ? views_json(*scene.sequence) : Json::array();
  json["has_poses"] = scene.sequence && scene.sequence->has_poses();
  json["has_changes"] = !scene.changes.empty();
  json["has_truth"] = scene.sequence && scene.sequence->has_ground_truth();
  json["objects"] = Json::array();
  for (const ObjectTable::Object& object : objects.objects())
    json["objects"].push_back(object_json(scene, object, static_cast<int>(json["objects"].size())));
  json["runs"] = Json::array();
  for (std::size_t r = 0; r < scene.runs.size(); ++r)
    json["runs"].push_back(run_json(scene.runs[r], stored_views[r], objects));
  return to_text(json);
}

std::string format_view(const ViewerScene& scene, const ObjectTable& objects, const RgbdFrame& frame,
                        const StoredView* stored, const SequenceNumbers& numbers,
                        const std::vector<GroundTruthObject>& truth) {
  const Camera& camera = frame.camera;
  const Rigid3 world_from_camera = stored != nullptr ? stored->world_from_camera : frame.world_from_camera;
  Json json = {{"camera", camera_json(camera)}};
  json["detections"] = Json::array();
  for (const StoredDetection& detection : stored != nullptr ? stored->detections : std::vector<StoredDetection>{}) {
    const int number = objects.find(detection.object);
    Json entry = details_json(detection, numbers);
    entry["truth_error"] = truth_error_json(detection, find_model(scene, number), world_from_camera, truth);
    entry["outline"] = outline_json(scene, number, camera, world_from_camera.inverse() * detection.world_from_object);
    json["detections"].push_back(std::move(entry));
  }
  json["truth"] = Json::array();
  for (const GroundTruthObject& object : truth) {
    const int number = objects.find(object.object);
    json["truth"].push_back({{"object", number},
                             {"name", object.object},
                             {"visible_share", object.visible_share},
                             {"pose", matrix_json(world_from_camera * object.camera_from_object)},
                             {"outline", outline_json(scene, number, camera, object.camera_from_object)}});
  }
  return to_text(json);
}

}  // namespace resight::viewer
